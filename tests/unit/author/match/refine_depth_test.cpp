// SPDX-License-Identifier: Apache-2.0
#include "author/match/refine_depth.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kWall = 5, kBoard = 4.5;  // world units in front of the first camera

// A wall and, optionally, a board in front of its right half, seen by three cameras. The match assigns the wall's depth
// everywhere, plus a quarter of a level.
struct Place {
  std::vector<MatchView> views;
  DenseMatch match;
  double truth = 0;

  explicit Place(bool board) {
    SyntheticOptions options;
    options.cameras = {lookingAlong({0, 0, 0}, {0, 1, 0}, 200, 150, 1.4),
                       lookingAlong({0.7, 0, 0.05}, {0, 1, 0}, 200, 150, 1.4),
                       lookingAlong({0.3, 0, 0.4}, {0, 1, 0}, 200, 150, 1.4)};
    options.planes = {TexturedPlane{{0, kWall, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.3}};
    match.frame = meanFrame(options.cameras);
    const glm::dvec3 edge{match.frame.pose.position.x, kBoard, 0};
    if (board) options.planes.push_back({edge + glm::dvec3(5, 0, 0), {1, 0, 0}, {0, 0, 1}, 10, 20, 2, 0.3});
    const SyntheticScene scene = makeScene(options);
    for (std::size_t i = 0; i < 3; ++i) views.push_back({options.cameras[i], scene.photographs[i]});
    match.inverseDepthStep = 0.01f;
    truth = 1 / (kWall - match.frame.pose.position.y);
    const Intrinsics& k = match.frame.intrinsics;
    match.inverseDepth = ImageF(k.width, k.height, 1, float(truth) + 0.25f * match.inverseDepthStep);
    match.good = Image8(k.width, k.height, 1, 1);
  }
};

}  // namespace

TEST_CASE("refined depths are closer to the truth, and unmatched pixels do not affect them") {
  Place wall(false), half(true);
  const Intrinsics& k = wall.match.frame.intrinsics;
  const int x = k.width / 2 - 3, y = k.height / 2;
  const double dense = wall.match.inverseDepth.pixel(x, y)[0];
  CHECK(std::abs(DepthRefiner(wall.views, wall.match).at(x, y) - wall.truth) < 0.2 * std::abs(dense - wall.truth));

  for (int v = 0; v < k.height; ++v)
    for (int u = k.width / 2 - 1; u < k.width; ++u) half.match.good.pixel(u, v)[0] = 0;
  CHECK(std::abs(DepthRefiner(half.views, half.match).at(x, y) - half.truth) < 0.3 * std::abs(dense - half.truth));
}
