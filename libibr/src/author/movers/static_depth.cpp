// SPDX-License-Identifier: Apache-2.0
#include "author/movers/static_depth.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/movers/colour_comparison.h"
#include "author/movers/disc.h"
#include "author/pixels/cv_view.h"

namespace ibr {
namespace {

constexpr int kRelaxationSweeps = 200;  // number of sweeps of successive over-relaxation
constexpr float kOverRelaxation = 1.9f;

}  // namespace

ImageF resampledDepth(const ImageF& inverseDepth, int width, int height) {
  ImageF result(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      result.pixel(x, y)[0] = inverseDepth.pixel(int((x + 0.5) * inverseDepth.width / width),
                                                 int((y + 0.5) * inverseDepth.height / height))[0];
  return result;
}

ImageF confirmedDepth(ImageF inverseDepth, const HalfSizeView& view, std::span<const HalfSizeView> others,
                      double minRadiusPx) {
  cv::Mat alike(inverseDepth.height, inverseDepth.width, CV_8U, cv::Scalar(0));
  for (const HalfSizeView& other : others) {
    const WarpedPhotograph w = warpedThrough(inverseDepth, view.camera, other);
    alike |= greyAgreement(view.colour, w.colour).alike & w.inside;
  }
  alike &= view.used & (cvView(inverseDepth) != kUnknownDepth);
  cv::morphologyEx(alike, alike, cv::MORPH_OPEN, disc(minRadiusPx));
  cvView(inverseDepth).setTo(kUnknownDepth, alike == 0);
  return inverseDepth;
}

ImageF harmonicDepth(ImageF inverseDepth, const cv::Mat& where) {
  std::vector<cv::Point> inside;
  cv::findNonZero(where, inside);
  const auto at = [&](int x, int y) {
    return inverseDepth.pixel(std::clamp(x, 0, inverseDepth.width - 1), std::clamp(y, 0, inverseDepth.height - 1))[0];
  };
  for (int sweep = 0; sweep < kRelaxationSweeps; ++sweep)
    for (const cv::Point p : inside) {
      float& value = inverseDepth.pixel(p.x, p.y)[0];
      const float mean = (at(p.x - 1, p.y) + at(p.x + 1, p.y) + at(p.x, p.y - 1) + at(p.x, p.y + 1)) / 4;
      value = std::max(value + kOverRelaxation * (mean - value), 0.0f);
    }
  return inverseDepth;
}

}  // namespace ibr
