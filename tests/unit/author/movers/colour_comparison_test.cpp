// SPDX-License-Identifier: Apache-2.0
// Comparisons of two images up to exposure and misalignment.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

#include "author/movers/colour_comparison.h"

using namespace ibr;

namespace {

constexpr int kSize = 20;

cv::Mat all(std::uint8_t value) {
  return {kSize, kSize, CV_8U, cv::Scalar(value)};
}

// Levels from 40 to 97, another one in each row, column and channel.
cv::Mat ramp() {
  cv::Mat picture(kSize, kSize, CV_32FC3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int c = 0; c < 3; ++c) picture.at<cv::Vec3f>(y, x)[c] = float(40 + 2 * x + y - c);
  return picture;
}

// The levels of each channel times its factor.
cv::Mat scaled(const cv::Mat& picture, cv::Vec3f factor) {
  cv::Mat result = picture.clone();
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int c = 0; c < 3; ++c) result.at<cv::Vec3f>(y, x)[c] *= factor[c];
  return result;
}

// A vertical edge: `left` before column `at`, then `right`.
cv::Mat edge(int at, cv::Scalar left, cv::Scalar right) {
  cv::Mat picture(kSize, kSize, CV_32FC3, left);
  picture.colRange(at, kSize).setTo(right);
  return picture;
}

// Stripes of four pixels: every window of seven pixels has both levels, also at the border.
cv::Mat stripes(float first, float second) {
  cv::Mat picture(kSize, kSize, CV_32FC3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) picture.at<cv::Vec3f>(y, x) = cv::Vec3f::all((x + 2) % 8 < 4 ? first : second);
  return picture;
}

}  // namespace

TEST_CASE("the exposure of each channel is matched by the median ratio") {
  const cv::Mat a = ramp();
  cv::Mat b = scaled(a, {0.5f, 1, 2});
  CHECK(cv::norm(exposureMatched(a, b, all(255)), a, cv::NORM_INF) < 1e-3);
  // A fifth of the image shows another object: the median ratio stays.
  b.rowRange(0, 4).setTo(cv::Scalar(200, 20, 30));
  const cv::Mat matched = exposureMatched(a, b, all(255));
  CHECK(cv::norm(matched.rowRange(4, kSize), a.rowRange(4, kSize), cv::NORM_INF) < 1e-3);
}

TEST_CASE("exposure is matched only by enough pixels that are neither dark nor saturated") {
  const cv::Mat a = ramp(), b = scaled(a, {0.5f, 0.5f, 0.5f});
  cv::Mat few = all(0);
  few.rowRange(0, 5).setTo(255);
  CHECK(cv::norm(exposureMatched(a, b, few), a, cv::NORM_INF) < 1e-3);  // 100 pixels
  few.at<std::uint8_t>(0, 0) = 0;
  CHECK(cv::norm(exposureMatched(a, b, few), b, cv::NORM_INF) == 0);
  const cv::Mat dark = scaled(a, {0.1f, 0.1f, 0.1f}), bright(kSize, kSize, CV_32FC3, cv::Scalar::all(255));
  CHECK(cv::norm(exposureMatched(a, dark, all(255)), dark, cv::NORM_INF) == 0);
  CHECK(cv::norm(exposureMatched(a, bright, all(255)), bright, cv::NORM_INF) == 0);
}

TEST_CASE("an edge that is off by at most the misalignment makes no difference") {
  const cv::Scalar low = cv::Scalar::all(20), high = cv::Scalar::all(120);
  const cv::Mat a = edge(8, low, high), b = edge(10, low, high);
  CHECK(cv::norm(colourDifference(a, b, 2, 1), cv::NORM_INF) == 0);
  const cv::Mat off = colourDifference(a, b, 1, 1);
  for (int x = 0; x < kSize; ++x) CHECK(off.at<float>(10, x) == Approx(x == 8 || x == 9 ? 100 : 0).margin(1e-3));
  CHECK(cv::norm(off, colourDifference(b, a, 1, 1), cv::NORM_INF) == 0);
}

TEST_CASE("a colour difference is the RMS of the channels, averaged over a window") {
  const cv::Mat a = edge(10, cv::Scalar(50, 60, 70), cv::Scalar(50, 60, 70));
  const cv::Mat b = edge(10, cv::Scalar(50, 60, 70), cv::Scalar(80, 60, 30));
  const float rms = std::sqrt((30.0f * 30 + 40.0f * 40) / 3);
  const cv::Mat off = colourDifference(a, b, 0, 1);
  CHECK(off.at<float>(5, 9) == 0);
  CHECK(off.at<float>(5, 10) == Approx(rms));
  const cv::Mat wide = colourDifference(a, b, 0, 3);
  CHECK(wide.at<float>(5, 8) == Approx(0).margin(1e-3));
  CHECK(wide.at<float>(5, 9) == Approx(rms / 3));
  CHECK(wide.at<float>(5, 10) == Approx(2 * rms / 3));
  CHECK(wide.at<float>(5, 12) == Approx(rms));
}

TEST_CASE("windows of grey agree up to exposure, and not with their negative") {
  const cv::Mat a = stripes(60, 120);
  const WindowAgreement brighter = greyAgreement(a, stripes(80, 160), 0.75);
  CHECK(cv::countNonZero(brighter.textured) == kSize * kSize);
  CHECK(cv::countNonZero(brighter.alike) == kSize * kSize);
  const WindowAgreement negative = greyAgreement(a, stripes(120, 60), 0.75);
  CHECK(cv::countNonZero(negative.textured) == 0);
  CHECK(cv::countNonZero(negative.alike) == 0);
}
