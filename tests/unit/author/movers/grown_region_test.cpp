// SPDX-License-Identifier: Apache-2.0
// Regions of moving objects, extended into pixels that no other photograph shows.
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <random>

#include "author/movers/grown_region.h"

using namespace ibr;

namespace {

const cv::Size kView(100, 100);
const cv::Rect kFound(40, 20, 20, 30), kHidden(40, 50, 20, 30);  // a person's upper and lower half
const cv::Rect kNeighbour(65, 56, 4, 20);                        // the same colour, apart from the person
constexpr int kOutlinePx = 5;

// A red person before a grey wall, with noise of up to 12 levels.
cv::Mat picture() {
  cv::Mat result(kView, CV_32FC3, cv::Scalar(90, 110, 120));
  for (const cv::Rect& red : {kFound, kHidden, kNeighbour}) result(red) = cv::Scalar(200, 60, 60);
  std::mt19937 random(3);
  for (int y = 0; y < kView.height; ++y)
    for (int x = 0; x < kView.width; ++x)
      for (int c = 0; c < 3; ++c) result.at<cv::Vec3f>(y, x)[c] += float(int(random() % 25) - 12);
  return result;
}

cv::Mat maskOf(cv::Rect box) {
  cv::Mat mask(kView, CV_8U, cv::Scalar(0));
  mask(box) = 255;
  return mask;
}

}  // namespace

TEST_CASE("a region grows into unseen pixels of its colours, and not into objects apart from it") {
  const cv::Mat unseen = maskOf({0, 50, 100, 50});
  const cv::Mat grown = grownRegion(maskOf(kFound), picture(), unseen, kOutlinePx);
  CHECK(cv::countNonZero(grown(kFound)) == kFound.area());
  CHECK(cv::countNonZero(grown(kHidden)) > 0.9 * kHidden.area());
  CHECK(cv::countNonZero(grown(kNeighbour)) == 0);
  CHECK(cv::countNonZero(grown) < 1.05 * (kFound.area() + kHidden.area()));  // the wall is left out
  CHECK(cv::norm(grown, grownRegion(maskOf(kFound), picture(), unseen, kOutlinePx), cv::NORM_INF) == 0);
}

TEST_CASE("a region without unseen pixels beside it stays") {
  const cv::Mat region = maskOf(kFound);
  for (const cv::Rect& unseen : {cv::Rect(0, 0, 5, 5), cv::Rect(0, 90, 100, 10), cv::Rect(40, 50, 2, 2)})
    CHECK(cv::norm(grownRegion(region, picture(), maskOf(unseen), kOutlinePx), region, cv::NORM_INF) == 0);
}

TEST_CASE("a region stays where no seen background is left to compare with") {
  const cv::Mat region = maskOf(kFound);
  CHECK(cv::norm(grownRegion(region, picture(), maskOf({{}, kView}), kOutlinePx), region, cv::NORM_INF) == 0);
}
