// SPDX-License-Identifier: Apache-2.0
#include "author/features/features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <tuple>

#include "author/pixels/cv_view.h"

namespace ibr {
namespace {

constexpr double kContrastThreshold = 0.004;  // a tenth of SIFT's usual threshold
constexpr double kEdgeThreshold = 12;
constexpr double kBlur = 1.4;        // of the first octave, px
constexpr double kMaxPerSquare = 4;  // features kept per square of the grid
// OpenCV puts pixel centres at 0. Its SIFT doubles the image without correcting for the shift of the centres: keypoints
// are a quarter of a pixel too far right and down.
constexpr float kToCentre = 0.5f - 0.25f;
constexpr int kMinSidePx = 16;  // px; smaller images get no features

using KeypointPosition = std::tuple<float, float, float>;
KeypointPosition placeOf(const cv::KeyPoint& k) {
  return {k.pt.y, k.pt.x, k.size};
}

Descriptor rooted(const float* values) {
  float sum = 0;
  for (std::size_t k = 0; k < 128; ++k) sum += values[k];
  Descriptor result{};
  if (sum > 0)
    for (std::size_t k = 0; k < 128; ++k) result[k] = std::int16_t(std::lround(512 * std::sqrt(values[k] / sum)));
  return result;
}

// Keeps the strongest keypoints of each square of a grid, with all their orientations.
std::vector<cv::KeyPoint> spread(std::vector<cv::KeyPoint> found, int width, int height, int most) {
  const double side = std::max(1.0, std::sqrt(kMaxPerSquare * width * height / most));
  const int columns = int(width / side) + 1;
  const auto square = [&](const cv::KeyPoint& k) {
    return int(double(k.pt.y) / side) * columns + int(double(k.pt.x) / side);
  };
  std::ranges::sort(found, [&](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    const int p = square(a), q = square(b);
    return std::tuple(p, -a.response, placeOf(a), a.angle) < std::tuple(q, -b.response, placeOf(b), b.angle);
  });
  std::vector<cv::KeyPoint> kept;
  int places = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const bool newSquare = k == 0 || square(found[k]) != square(found[k - 1]);
    if (newSquare) places = 0;
    if (newSquare || placeOf(found[k]) != placeOf(found[k - 1])) ++places;
    if (places <= kMaxPerSquare) kept.push_back(found[k]);
  }
  return kept;
}

}  // namespace

Features detectFeatures(const Image8& grey, int most) {
  Features features;
  if (std::min(grey.width, grey.height) < kMinSidePx) return features;
  const auto sift = cv::SIFT::create(0, 3, kContrastThreshold, kEdgeThreshold, kBlur);
  std::vector<cv::KeyPoint> found;
  sift->detect(cvView(grey), found);
  found = spread(std::move(found), grey.width, grey.height, most);
  cv::Mat values;
  if (!found.empty()) sift->compute(cvView(grey), found, values);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k == 0 || placeOf(found[k]) != placeOf(found[k - 1])) {
      features.at.emplace_back(found[k].pt.x + kToCentre, found[k].pt.y + kToCentre);
      features.first.push_back(features.first.back());
    }
    features.descriptor.push_back(rooted(values.ptr<float>(int(k))));
    ++features.first.back();
  }
  return features;
}

}  // namespace ibr
