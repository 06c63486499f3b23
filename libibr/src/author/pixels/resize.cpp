// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/photographs.h"

#include <opencv2/imgproc.hpp>

#include "author/pixels/cv_view.h"

namespace ibr {

Image8 downscaled(const Image8& picture, int width, int height) {
  Image8 small(width, height, 3);
  cv::Mat to = cvView(small);
  cv::resize(cvView(picture), to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

Image8 toGrey(const Image8& picture) {
  Image8 grey(picture.width, picture.height, 1);
  cv::Mat to = cvView(grey);
  cv::cvtColor(cvView(picture), to, cv::COLOR_RGB2GRAY);
  return grey;
}

}  // namespace ibr
