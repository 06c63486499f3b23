// SPDX-License-Identifier: Apache-2.0
#include "author/layers.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "author/match.h"
#include "author/mesh.h"
#include "author/orientation.h"
#include "scene/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kBoard = 2.6, kWall = 5.0;  // distances along the cameras' axes
constexpr double kRight = 0.6;               // the board's right edge in the world

// A wall, and a board that stands before its middle; three cameras in a plane parallel to both.
struct Stage {
  std::vector<Camera> cameras;
  std::vector<MatchView> views;
  std::vector<glm::dvec3> points;
};
Stage makeStage(bool board) {
  Stage stage;
  stage.cameras = {lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({0.4, 0, 0}, {0, 1, 0}),
                   lookingAlong({0.15, 0, 0.35}, {0, 1, 0})};
  SyntheticOptions options;
  options.cameras = stage.cameras;
  options.planes = {{{0, kWall, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.16}};
  if (board) options.planes.push_back({{0, kBoard, 0.1}, {1, 0, 0}, {0, 0, 1}, 2 * kRight, 1.2, 2, 0.08});
  options.samplesPerAxis = 3;
  const SyntheticScene scene = makeScene(options);
  for (std::size_t i = 0; i < 3; ++i) stage.views.push_back({stage.cameras[i], scene.photographs[i]});
  for (int i = 0; i < 50; ++i)
    stage.points.emplace_back(-1 + 0.05 * i, i % 2 && board ? kBoard : kWall, 0.02 * i - 0.5);
  return stage;
}


}  // namespace

TEST_CASE("signed areas on the grid are exact") {
  const std::vector<glm::vec2> at{snapped({30000.0 / 3, 1.0 / 3}), snapped({30000.0 / 3 + 1.0 / 512, 1.0 / 3}),
                                  snapped({30000.0 / 3, 1.0 / 3 + 1.0 / 512}), snapped({-5, 2})};
  CHECK(twiceArea(at, {0, 1, 2}) == 1);
  CHECK(twiceArea(at, {0, 2, 1}) == -1);
  CHECK(twiceArea(at, {0, 1, 1}) == 0);
  CHECK(double(at[0].x) * kGridPerPixel == std::round(double(at[0].x) * kGridPerPixel));
  CHECK(std::abs(double(snapped({32767.999, 0}).x) - 32767.999) <= 0.5 / kGridPerPixel);
}

TEST_CASE("a depth edge is cut where the near surface ends, and both sides have their own depth") {
  const Stage stage = makeStage(true);
  const DenseMatch match = matchViews(stage.views, stage.points);
  const SilhouetteFinder finder(stage.views, match);
  const Intrinsics& k = match.frame.intrinsics;
  const double x0 = match.frame.pose.position.x;
  const double edge = k.cx + k.fx * (kRight - x0) / kBoard;  // px of the frame
  int found = 0;
  for (int row = 0; row < 5; ++row) {
    const glm::dvec2 inside(std::floor(edge) - 8.5, k.cy - 8.5 + 4 * row), outside = inside + glm::dvec2(16, 0);
    const SurfaceSample near = finder.surface(inside, 1 / kBoard), far = finder.surface(outside, 1 / kWall);
    CHECK(glm::length(near.slope) < 0.01);
    const auto part = finder.between(near, far);
    REQUIRE(part);
    found += std::abs(inside.x + 16 * *part - edge) < 1.0;
    CHECK(std::abs(inside.x + 16 * *part - edge) < 3.0);
    CHECK_FALSE(finder.between(far, near));
    CHECK_FALSE(finder.between(near, finder.surface(inside - glm::dvec2(0, 6), 1 / kBoard)));
  }
  CHECK(found >= 4);
}

TEST_CASE("layers of a cell lie the same way in every member, and share no vertex") {
  const Stage stage = makeStage(true);
  const CellMesh cell = buildMesh(stage.cameras, stage.views, matchViews(stage.views, stage.points));
  const MorphMesh& mesh = cell.mesh;
  Scene scene;
  for (std::size_t i = 0; i < 3; ++i) scene.nodes.push_back({std::to_string(i), stage.cameras[i], {}, {}});
  scene.cells.push_back({{0, 1, 2}, mesh, cell.quality});
  CHECK(validate(scene).empty());
  std::set<unsigned> used;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) used.insert(mesh.triangles[t][k]);
  CHECK(used.size() > 100);
  for (std::size_t t = 0; t < mesh.tier0Count(); ++t)
    for (const auto& at : mesh.match) CHECK(twiceArea(at, mesh.triangles[t]) > 0);

  // What agrees in all members reaches the board's border with the board's depth: nothing spans the two.
  const double nearRho = 1 / kBoard, farRho = 1 / kWall;
  std::size_t across = 0, right = 0;
  for (std::size_t t = 0; t < mesh.tier0Count(); ++t) {
    float low = 1e9f, high = 0;
    for (int k = 0; k < 3; ++k) {
      low = std::min(low, mesh.inverseDistance[mesh.triangles[t][k]]);
      high = std::max(high, mesh.inverseDistance[mesh.triangles[t][k]]);
    }
    across += double(high - low) > 0.5 * (nearRho - farRho);
  }
  CHECK(across == 0);
  const double border = stage.cameras[0].intrinsics.cx + stage.cameras[0].intrinsics.fx * kRight / kBoard;
  for (std::size_t v = 0; v < mesh.pointCount(); ++v)
    right += std::abs(double(mesh.match[0][v].x) - border) < 0.6 && double(mesh.inverseDistance[v]) > 0.8 * nearRho;
  CHECK(right >= 5);
}

TEST_CASE("without depth edges nothing is cut") {
  const Stage stage = makeStage(false);
  const DenseMatch match = matchViews(stage.views, stage.points);
  const SilhouetteFinder finder(stage.views, match);
  const std::vector<glm::vec2> frame{{40.5f, 40.5f}, {72.5f, 40.5f}, {40.5f, 72.5f}};
  std::vector<double> depth;
  for (const glm::vec2 at : frame) depth.push_back(double(match.inverseDepth.pixel(int(at.x), int(at.y))[0]));
  const std::vector<glm::uvec3> triangles{{0, 1, 2}};
  const Layers layers = cutAtSilhouettes(finder, frame, depth, triangles, {true});
  CHECK(layers.splits.empty());
  CHECK(layers.vertices.empty());
  const CellMesh once = buildMesh(stage.cameras, stage.views, match);
  const CellMesh again = buildMesh(stage.cameras, stage.views, match);
  CHECK(once.mesh.match == again.mesh.match);
}
