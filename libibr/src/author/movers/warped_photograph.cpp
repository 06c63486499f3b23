// SPDX-License-Identifier: Apache-2.0
#include "author/movers/warped_photograph.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "author/geometry/mean_frame.h"
#include "author/photographs/masks.h"
#include "author/pixels/cv_view.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

// `depthAt`: returns the inverse depth of a pixel of the box.
template <class DepthAt>
WarpedPhotograph warped(const Camera& frame, cv::Rect box, const HalfSizeView& photograph, const DepthAt& depthAt) {
  const FrameToMember map = frameToMember(frame, photograph.camera);
  const Intrinsics& k = photograph.camera.intrinsics;
  cv::Mat at(box.size(), CV_32FC2);
  WarpedPhotograph result{{}, cv::Mat(box.size(), CV_8U, cv::Scalar(0))};
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      const auto pixel = map({box.x + x + 0.5, box.y + y + 0.5}, double(depthAt(box.x + x, box.y + y)));
      const glm::dvec2 p = pixel.value_or(glm::dvec2(-1));
      at.at<cv::Vec2f>(y, x) = {float(p.x - 0.5), float(p.y - 0.5)};
      if (p.x < 1 || p.y < 1 || p.x > k.width - 1 || p.y > k.height - 1) continue;
      result.inside.at<std::uint8_t>(y, x) = photograph.used.at<std::uint8_t>(int(p.y), int(p.x));
    }
  cv::remap(photograph.colour, result.colour, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace

HalfSizeView halfSizeView(const MatchView& view, int maskMarginPx) {
  const int width = std::max(view.picture.width / 2, 1), height = std::max(view.picture.height / 2, 1);
  HalfSizeView half{{resized(view.camera.intrinsics, width, height), view.camera.pose}, {}, {}};
  const Image8 small = downscaled(view.picture, width, height);
  cvView(small).convertTo(half.colour, CV_32F);
  const Image8 mask = widenedMask(resizedMask(view.mask, width, height), maskMarginPx);
  half.used = mask.empty() ? cv::Mat(height, width, CV_8U, cv::Scalar(255)) : cvView(mask).clone();
  return half;
}

WarpedPhotograph warpedThrough(const ImageF& inverseDepth, const Camera& frame, const HalfSizeView& photograph) {
  return warped(frame, {0, 0, inverseDepth.width, inverseDepth.height}, photograph,
                [&](int x, int y) { return inverseDepth.pixel(x, y)[0]; });
}

WarpedPhotograph warpedAtDepth(float inverseDepth, const Camera& frame, cv::Rect box, const HalfSizeView& photograph) {
  return warped(frame, box, photograph, [&](int, int) { return inverseDepth; });
}

}  // namespace ibr
