// SPDX-License-Identifier: Apache-2.0
// Depth of static surfaces: resampled, confirmed by another photograph, harmonic.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/movers/static_depth.h"

using namespace ibr;

namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr float kWall = 0.25f;  // inverse depth, 1 / world unit
constexpr int kParallax = 8;    // px, of the two cameras, at kWall

HalfSizeView viewAt(double x) {
  HalfSizeView view{{}, cv::Mat(kHeight, kWidth, CV_32FC3), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255))};
  view.camera.intrinsics = {CameraModel::pinhole, kWidth, kHeight, 32, 32, kWidth / 2.0, kHeight / 2.0};
  view.camera.pose.position = {x, 0, 0};
  return view;
}

// Two cameras one world unit apart before a wall of noise.
struct Pair {
  HalfSizeView left = viewAt(0);
  std::vector<HalfSizeView> others{viewAt(1)};

  Pair() {
    std::mt19937 random(5);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth + kParallax; ++x) {
        const cv::Vec3f colour = cv::Vec3f::all(float(40 + random() % 160));
        if (x < kWidth) left.colour.at<cv::Vec3f>(y, x) = colour;
        if (x >= kParallax) others[0].colour.at<cv::Vec3f>(y, x - kParallax) = colour;
      }
  }
};

// Number of pixels of the box with this value.
int countOf(const ImageF& depth, cv::Rect box, float value) {
  int count = 0;
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x) count += depth.pixel(x, y)[0] == value;
  return count;
}

}  // namespace

TEST_CASE("resampled depth has the values of the nearest pixels only") {
  ImageF map(2, 2, 1);
  map.values = {1, 2, 3, kUnknownDepth};
  const ImageF large = resampledDepth(map, 4, 6);
  CHECK(countOf(large, {0, 0, 2, 3}, 1) == 6);
  CHECK(countOf(large, {2, 0, 2, 3}, 2) == 6);
  CHECK(countOf(large, {0, 3, 2, 3}, 3) == 6);
  CHECK(countOf(large, {2, 3, 2, 3}, kUnknownDepth) == 6);
  CHECK(resampledDepth(large, 2, 2) == map);
  ImageF row(3, 1, 1);
  row.values = {1, 2, 3};
  CHECK(resampledDepth(row, 2, 1).values == std::vector<float>{1, 3});  // centres at 0.75 and 2.25
}

TEST_CASE("depth is kept where another photograph looks alike at that depth, and dropped elsewhere") {
  const Pair pair;
  ImageF depth(kWidth, kHeight, 1, kWall);
  for (int y = 16; y < 32; ++y)
    for (int x = 30; x < 46; ++x) depth.pixel(x, y)[0] = 2 * kWall;  // wrong
  const ImageF confirmed = confirmedDepth(depth, pair.left, pair.others, 3);
  CHECK(countOf(confirmed, {35, 21, 6, 6}, kUnknownDepth) == 36);
  CHECK(countOf(confirmed, {16, 8, 10, 32}, kWall) == 320);
  CHECK(countOf(confirmed, {0, 0, kParallax, kHeight}, kUnknownDepth) == kParallax * kHeight);  // outside the other
  CHECK(countOf(confirmedDepth(depth, pair.left, {}, 3), {0, 0, kWidth, kHeight}, kUnknownDepth) == kWidth * kHeight);
}

TEST_CASE("depth under a mask is dropped, and unknown depth stays unknown") {
  Pair pair;
  ImageF depth(kWidth, kHeight, 1, kWall);
  depth.pixel(50, 24)[0] = kUnknownDepth;
  pair.left.used.at<std::uint8_t>(24, 20) = 0;
  pair.others[0].used.at<std::uint8_t>(24, 35 - kParallax) = 0;
  const ImageF confirmed = confirmedDepth(depth, pair.left, pair.others, 1);
  CHECK(confirmed.pixel(20, 24)[0] == kUnknownDepth);
  CHECK(confirmed.pixel(35, 24)[0] == kUnknownDepth);
  CHECK(confirmed.pixel(50, 24)[0] == kUnknownDepth);
  CHECK(confirmed.pixel(28, 24)[0] == kWall);
}

TEST_CASE("harmonic depth continues a plane, and leaves other pixels to the bit") {
  ImageF plane(24, 16, 1), damaged;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) plane.pixel(x, y)[0] = 0.1f + 0.01f * float(x) + 0.02f * float(y);
  damaged = plane;
  cv::Mat where(16, 24, CV_8U, cv::Scalar(0));
  where(cv::Rect(7, 5, 9, 6)) = 255;
  for (int y = 5; y < 11; ++y)
    for (int x = 7; x < 16; ++x) damaged.pixel(x, y)[0] = 0.9f;
  const ImageF filled = harmonicDepth(damaged, where);
  float inside = 0;
  int changed = 0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      const float off = std::abs(filled.pixel(x, y)[0] - plane.pixel(x, y)[0]);
      if (where.at<std::uint8_t>(y, x))
        inside = std::max(inside, off);
      else
        changed += off != 0;
    }
  CHECK(inside < 1e-4f);
  CHECK(changed == 0);
}
