// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/depth_edges.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace ibr;

namespace {

constexpr int kWidth = 96, kHeight = 64;
constexpr double kFocal = 80, kBoardDepth = 2, kWallDepth = 10, kHalfBoard = 0.4;  // px, then world units
constexpr float kBoard = 5, kWall = 1;                                             // levels

// A board before a wall, in grey levels; the wall is textured or plain.
struct Place {
  bool textured = true;

  static double pattern(double x, double y) { return 25 * (std::sin(23 * x + 9 * y) + std::sin(31 * y - 17 * x)); }
  double at(const Camera& camera, double px, double py) const {
    const Intrinsics& k = camera.intrinsics;
    const double x = (px - k.cx) / k.fx, y = (k.cy - py) / k.fy;
    const double bx = camera.pose.position.x + kBoardDepth * x, by = kBoardDepth * y;
    if (std::abs(bx) < kHalfBoard && std::abs(by) < kHalfBoard) return 90 + pattern(bx, by);
    const double wx = camera.pose.position.x + kWallDepth * x, wy = kWallDepth * y;
    return 190 + (textured ? pattern(wx / 4, wy / 4) : 0);
  }
};

Camera cameraAt(double x) {
  Camera camera;
  camera.intrinsics.width = kWidth;
  camera.intrinsics.height = kHeight;
  camera.intrinsics.fx = camera.intrinsics.fy = kFocal;
  camera.intrinsics.cx = kWidth / 2.0;
  camera.intrinsics.cy = kHeight / 2.0;
  camera.pose.position.x = x;
  return camera;
}

struct Swept {
  Camera frame = cameraAt(0);
  std::vector<SweepView> views;
  SweepLevels range{{0, 0.1, 0.2, 0.3, 0.4, 0.5}, 0.1};
  ImageF guide{kWidth, kHeight, 1};

  explicit Swept(const Place& place) {
    for (const double x : {-0.2, 0.2, 0.07}) {
      SweepView& view = views.emplace_back(SweepView{cameraAt(x), ImageF(kWidth, kHeight, 1)});
      for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) view.grey.pixel(u, v)[0] = float(place.at(view.camera, u + 0.5, v + 0.5));
    }
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) guide.pixel(u, v)[0] = float(place.at(frame, u + 0.5, v + 0.5));
  }

  // Returns the true levels; the board is `wider` px wider on every side.
  static ImageF levels(int wider) {
    ImageF level(kWidth, kHeight, 1);
    const double half = kFocal * kHalfBoard / kBoardDepth + wider;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        const bool board = std::abs(u + 0.5 - kWidth / 2.0) < half && std::abs(v + 0.5 - kHeight / 2.0) < half;
        level.pixel(u, v)[0] = board ? kBoard : kWall;
      }
    return level;
  }

  // Returns the number of pixels that are wrong after trimming.
  int wrongAfter(int wider) const {
    ImageF level = levels(wider);
    trimForegrounds(frame, views, range, guide, level);
    const ImageF truth = levels(0);
    int wrong = 0;
    for (std::size_t p = 0; p < level.values.size(); ++p) wrong += level.values[p] != truth.values[p];
    return wrong;
  }
};

}  // namespace

TEST_CASE("foregrounds that are too wide are trimmed to their silhouettes, with and without texture") {
  const bool textured = GENERATE(true, false);
  CAPTURE(textured);
  const Swept swept(Place{textured});
  constexpr int kOutline = 4 * 32;  // px
  CHECK(swept.wrongAfter(0) <= kOutline / 4);
  CHECK(swept.wrongAfter(3) <= kOutline);      // of more than 400 that were wrong at first
  CHECK(swept.wrongAfter(12) > kOutline * 4);  // trimming reaches as far as the matching windows only
}

TEST_CASE("a map without depth edges is not trimmed") {
  const Swept swept(Place{});
  ImageF level(kWidth, kHeight, 1);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) level.pixel(u, v)[0] = 0.05f * float(u);
  const ImageF before = level;
  trimForegrounds(swept.frame, swept.views, swept.range, swept.guide, level);
  CHECK(level.values == before.values);
}
