// SPDX-License-Identifier: Apache-2.0
#include "author/movers/colour_comparison.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace ibr {
namespace {

constexpr float kDarkLevel = 12, kSaturatedLevel = 250;  // 8-bit levels between which exposures are compared
constexpr std::size_t kMinExposurePixels = 100;          // minimum number of pixels for the ratio of a channel

cv::Mat grey(const cv::Mat& colour) {
  cv::Mat result;
  cv::cvtColor(colour, result, cv::COLOR_RGB2GRAY);
  return result;
}

// Distance of `one` from the range of values of `other` within `around`, mean over a window.
cv::Mat outside(const cv::Mat& one, const cv::Mat& other, const cv::Mat& around, int windowPx) {
  cv::Mat high, low;
  cv::dilate(other, high, around);
  cv::erode(other, low, around);
  cv::Mat off = cv::max(one - high, 0) + cv::max(low - one, 0);
  std::array<cv::Mat, 3> channel;
  cv::split(off, channel.data());
  cv::Mat square = channel[0].mul(channel[0]) + channel[1].mul(channel[1]) + channel[2].mul(channel[2]), length;
  cv::sqrt(square / 3, length);
  cv::blur(length, length, {windowPx, windowPx});
  return length;
}

}  // namespace

WindowAgreement greyAgreement(const cv::Mat& a, const cv::Mat& b, double correlation) {
  return agreement(grey(a), grey(b), correlation);
}

cv::Mat exposureMatched(const cv::Mat& a, const cv::Mat& b, const cv::Mat& where) {
  cv::Mat result = b.clone();
  std::array<std::vector<float>, 3> ratios;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      if (!where.at<std::uint8_t>(y, x)) continue;
      const cv::Vec3f va = a.at<cv::Vec3f>(y, x), vb = b.at<cv::Vec3f>(y, x);
      for (int c = 0; c < 3; ++c)
        if (std::min(va[c], vb[c]) > kDarkLevel && std::max(va[c], vb[c]) < kSaturatedLevel)
          ratios[std::size_t(c)].push_back(va[c] / vb[c]);
    }
  cv::Scalar gain(1, 1, 1);
  for (int c = 0; c < 3; ++c) {
    std::vector<float>& r = ratios[std::size_t(c)];
    if (r.size() < kMinExposurePixels) continue;
    const auto middle = r.begin() + std::ptrdiff_t(r.size() / 2);
    std::nth_element(r.begin(), middle, r.end());
    gain[c] = double(*middle);
  }
  cv::multiply(result, gain, result);
  return result;
}

cv::Mat colourDifference(const cv::Mat& a, const cv::Mat& b, int misalignmentPx, int windowPx) {
  const cv::Mat around = cv::getStructuringElement(cv::MORPH_RECT, {2 * misalignmentPx + 1, 2 * misalignmentPx + 1});
  return cv::max(outside(a, b, around, windowPx), outside(b, a, around, windowPx));
}

}  // namespace ibr
