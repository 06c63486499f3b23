// SPDX-License-Identifier: Apache-2.0
// Wraps images as OpenCV matrices without copying: the pixels are shared.
#pragma once

#include <opencv2/core.hpp>

#include "ibr/image.h"

namespace ibr {

inline cv::Mat cvView(const Image8& image) {
  return {image.height, image.width, CV_8UC(image.channels), const_cast<std::uint8_t*>(image.values.data())};
}
inline cv::Mat cvView(const ImageF& image) {
  return {image.height, image.width, CV_32FC(image.channels), const_cast<float*>(image.values.data())};
}

}  // namespace ibr
