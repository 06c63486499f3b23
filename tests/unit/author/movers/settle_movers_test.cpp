// SPDX-License-Identifier: Apache-2.0
// Masks for moving objects that were detected in single photographs, and detection of unmatched patches.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "author/movers/patch_dissimilarity.h"
#include "author/movers/settle_movers.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 200, kHeight = 120;
constexpr float kWall = 0.25f;  // inverse depth, 1 / world unit

DifferingRegion box(RegionOwner owner, int left, int top, int right, int bottom) {
  DifferingRegion region{owner, 0, {}};
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) region.pixels.push_back({std::uint16_t(x), std::uint16_t(y), kWall});
  return region;
}

// Two cameras side by side before a wall: the second sees a point `shift` px to the left of its position in the first.
struct Pair {
  std::vector<ComparedView> views;
  int shift;

  explicit Pair(double apart = 1) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      ComparedView view{lookingAlong({i ? apart : 0, 0, 0}, {0, 1, 0}, kWidth, kHeight), {1 - i}, {}};
      view.found = {kWidth, kHeight, {}, ImageF(kWidth / kDepthStep, kHeight / kDepthStep, 1, kWall)};
      views.push_back(view);
    }
    shift = int(std::lround(apart * double(kWall) * views[0].camera.intrinsics.fx));
  }
};

bool covers(const BitMask& mask, int left, int top, int right, int bottom) {
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      if (!mask.at(x, y)) return false;
  return true;
}

int countOf(const BitMask& mask) {
  int count = 0;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) count += mask.at(x, y);
  return count;
}

}  // namespace

TEST_CASE("a moving object is masked in its own photograph, with a rim, and in no other") {
  Pair pair;
  pair.views[0].found.regions = {box(RegionOwner::own, 100, 40, 120, 80)};
  const std::vector<BitMask> masks = resolveMoverMasks(pair.views);
  CHECK(covers(masks[0], 100, 40, 120, 80));
  CHECK(covers(masks[0], 98, 45, 122, 75));
  CHECK(countOf(masks[0]) < 26 * 46);
  CHECK(masks[1].empty());
}

TEST_CASE("an object that hides background no other photograph shows is kept, and the others are masked there") {
  Pair pair;
  const int x = pair.shift;  // the second camera does not see the first `shift` columns
  REQUIRE(x > 10);
  pair.views[0].found.regions = {box(RegionOwner::own, x - 10, 40, x + 10, 80)};
  std::vector<BitMask> masks = resolveMoverMasks(pair.views);
  CHECK(masks[0].empty());
  REQUIRE_FALSE(masks[1].empty());
  CHECK(covers(masks[1], 1, 41, 9, 79));
  CHECK_FALSE(masks[1].at(20, 60));
  // Both hide the same background: one photograph keeps the object, and the other one is masked.
  Pair both;
  both.views[0].found.regions = {box(RegionOwner::own, 100, 40, 120, 80)};
  both.views[1].found.regions = {box(RegionOwner::own, 100 - x, 40, 120 - x, 80)};
  masks = resolveMoverMasks(both.views);
  CHECK((masks[0].empty() != masks[1].empty()));
  const bool first = masks[1].empty();
  CHECK(covers(masks[first ? 0 : 1], first ? 100 : 100 - x, 40, first ? 120 : 120 - x, 80));
}

TEST_CASE("an unsure photograph is masked if another one disagrees, unless their depths differ") {
  Pair pair;
  const int x = pair.shift;
  pair.views[0].found.regions = {box(RegionOwner::unsure, 100, 40, 120, 80)};
  CHECK(resolveMoverMasks(pair.views)[0].empty());
  pair.views[1].found.regions = {box(RegionOwner::another, 100 - x, 40, 120 - x, 60)};
  CHECK(covers(resolveMoverMasks(pair.views)[0], 100, 40, 120, 80));
  // The second photograph has another depth in that direction, so it does not see the wall there.
  std::ranges::fill(pair.views[1].found.depth.values, 2 * kWall);
  CHECK(resolveMoverMasks(pair.views)[0].empty());
  // A camera that looks away does not see the wall either.
  Pair away;
  away.views[0].found.regions = {box(RegionOwner::own, 100, 40, 120, 80)};
  away.views[1].camera = lookingAlong({0, 0, 0}, {0, -1, 0}, kWidth, kHeight);
  for (const BitMask& mask : resolveMoverMasks(away.views)) CHECK(mask.empty());
  CHECK(resolveMoverMasks({}).empty());
}

TEST_CASE("only patches without a similar patch around them are unmatched") {
  cv::Mat wall(60, 80, CV_32FC3);
  for (int y = 0; y < wall.rows; ++y)
    for (int x = 0; x < wall.cols; ++x) wall.at<cv::Vec3f>(y, x) = cv::Vec3f::all(x % 8 < 4 ? 80.0f : 160.0f);
  cv::Mat somebody = wall.clone();
  somebody(cv::Rect(30, 20, 16, 20)) = cv::Scalar(250, 20, 60);
  cv::Mat where(60, 80, CV_8U, cv::Scalar(0));
  where(cv::Rect(30, 20, 16, 20)) = 255;
  const std::array<cv::Mat, 2> both{somebody, wall};
  const cv::Mat around = where == 0;
  CHECK(cv::mean(patchDissimilarity(wall, where, both, around), where)[0] < 1);
  CHECK(cv::mean(patchDissimilarity(somebody, where, std::span(both).last(1), around), where)[0] > 60);
  CHECK(cv::countNonZero(patchDissimilarity(somebody, where, both, around) > 0) <= 16 * 20);
  CHECK(cv::countNonZero(patchDissimilarity(somebody, where, both, cv::Mat(60, 80, CV_8U, cv::Scalar(0)))) == 0);
  CHECK(cv::countNonZero(patchDissimilarity(somebody, where, {}, around)) == 0);
}
