// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/layers.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <iterator>
#include <set>
#include <span>
#include <vector>

#include "author/geometry/orientation.h"
#include "author/match/match.h"
#include "author/mesh/mesh.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kBoard = 2.6, kWall = 5.0;  // distances along the cameras' axes, world units
constexpr double kRight = 0.6;               // x of the board's right edge in the world

// Three cameras in a plane parallel to the board, which is in front of the wall's middle.
struct Stage {
  std::vector<Camera> cameras;
  std::vector<MatchView> views;
  std::vector<glm::dvec3> points;
};
Stage makeStage(const std::vector<TexturedPlane>& planes) {
  Stage stage;
  stage.cameras = {lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({0.4, 0, 0}, {0, 1, 0}),
                   lookingAlong({0.15, 0, 0.35}, {0, 1, 0})};
  SyntheticOptions options;
  options.cameras = stage.cameras;
  options.planes = planes;
  options.samplesPerAxis = 3;
  const SyntheticScene scene = makeScene(options);
  for (std::size_t i = 0; i < 3; ++i) stage.views.push_back({stage.cameras[i], scene.photographs[i]});
  for (int i = 0; i < 50; ++i) {
    const TexturedPlane& plane = planes[std::size_t(i) % planes.size()];
    const double across = std::min(plane.extentU, 6.0) * (i / 49.0 - 0.5);
    stage.points.push_back(plane.origin + across * plane.u + (0.02 * i - 0.5) * plane.v);
  }
  return stage;
}
const TexturedPlane kTheWall{{0, kWall, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.16};
const TexturedPlane kTheBoard{{0, kBoard, 0.1}, {1, 0, 0}, {0, 0, 1}, 2 * kRight, 1.2, 2, 0.08};
const TexturedPlane kSlantedWall{
    {0, kWall, 0}, {M_SQRT1_2, M_SQRT1_2, 0}, {0, 0, 1}, 40, 20, 1, 0.4};  // covers the view at a distance as well

// Returns the vertices of the triangles.
std::set<unsigned> cornersOf(std::span<const glm::uvec3> triangles) {
  std::set<unsigned> corners;
  for (const glm::uvec3& t : triangles) corners.insert({t.x, t.y, t.z});
  return corners;
}

std::vector<unsigned> shared(const std::set<unsigned>& a, const std::set<unsigned>& b) {
  std::vector<unsigned> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

// Grid of right-angled triangles over the middle of the frame, which all members see, with the match's depths.
struct Grid {
  std::vector<glm::vec2> frame;
  std::vector<double> depth;
  std::vector<glm::uvec3> triangles;
};
Grid gridOver(const DenseMatch& match) {
  constexpr int kMargin = 32, kSide = 40;  // px
  const unsigned across = unsigned((match.good.width - 2 * kMargin) / kSide),
                 down = unsigned((match.good.height - 2 * kMargin) / kSide);
  Grid grid;
  for (unsigned y = 0; y <= down; ++y)
    for (unsigned x = 0; x <= across; ++x) {
      const int u = kMargin + kSide * int(x), v = kMargin + kSide * int(y);
      grid.frame.emplace_back(float(u) + 0.5f, float(v) + 0.5f);
      grid.depth.push_back(double(match.inverseDepth.pixel(u, v)[0]));
      const unsigned here = y * (across + 1) + x, below = here + across + 1;
      if (x == across || y == down) continue;
      grid.triangles.push_back({here, below, here + 1});
      grid.triangles.push_back({here + 1, below, below + 1});
    }
  return grid;
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
  const Stage stage = makeStage({kTheWall, kTheBoard});
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

TEST_CASE("a triangle across a depth edge becomes pieces of two surfaces that share no vertex") {
  const Stage stage = makeStage({kTheWall, kTheBoard});
  const DenseMatch match = matchViews(stage.views, stage.points);
  const SilhouetteFinder finder(stage.views, match);
  const Intrinsics& k = match.frame.intrinsics;
  const auto edge = float(k.cx + k.fx * (kRight - match.frame.pose.position.x) / kBoard), middle = float(k.cy);
  const double nearW = 1 / kBoard, farW = 1 / kWall;
  // The first triangle has one corner on the board, the second has two; the cut crosses their shared edge.
  const std::vector<glm::vec2> frame{snapped({edge - 8, middle - 8}), snapped({edge + 8, middle}),
                                     snapped({edge - 8, middle + 8}), snapped({edge + 8, middle - 16})};
  const std::vector<double> depth{nearW, farW, nearW, farW};
  const std::vector<glm::uvec3> triangles{{0, 1, 3}, {0, 2, 1}};
  const Layers layers = cutAtSilhouettes(finder, frame, depth, triangles, {true, true});
  REQUIRE(layers.splits.size() == 2);
  std::vector<double> depths = depth;
  std::vector<glm::vec2> places = frame;
  for (const LayerVertex& vertex : layers.vertices) {
    depths.push_back(vertex.place.inverseDepth);
    places.emplace_back(vertex.place.pixel);
  }
  std::vector<glm::uvec3> near, far;
  for (const LayerSplit& split : layers.splits) {
    std::int64_t covered = 0;
    for (const glm::uvec3& piece : split.surface) {
      const bool onBoard = std::min({depths[piece.x], depths[piece.y], depths[piece.z]}) > 0.5 * (nearW + farW);
      (onBoard ? near : far).push_back(piece);
      covered += twiceArea(places, piece);
    }
    CHECK(std::abs(double(covered) / double(twiceArea(places, triangles[split.triangle])) - 1) < 0.01);
    far.insert(far.end(), split.behind.begin(), split.behind.end());
  }
  CHECK(near.size() == 3);
  CHECK(far.size() == 6);
  CHECK(shared(cornersOf(near), cornersOf(far)).empty());
  for (const unsigned v : cornersOf(near)) CHECK(depths[v] == Approx(nearW).epsilon(0.05));
  for (const unsigned v : cornersOf(far)) CHECK(depths[v] == Approx(farW).epsilon(0.05));
  // The shared edge is cut once and gets two vertices, as do two more edges; each near corner gets a duplicate.
  CHECK(layers.vertices.size() == 2 * 3 + 2);
}

TEST_CASE("layers of a cell have the same orientation in every member, and share no vertex") {
  const Stage stage = makeStage({kTheWall, kTheBoard});
  const CellMesh cell = buildMesh(stage.cameras, stage.views, matchViews(stage.views, stage.points));
  const MorphMesh& mesh = cell.mesh;
  Scene scene;
  for (std::size_t i = 0; i < 3; ++i) scene.nodes.push_back({std::to_string(i), stage.cameras[i], {}, {}});
  scene.cells.push_back({{0, 1, 2}, mesh, cell.quality});
  CHECK(validate(scene).empty());
  CHECK(cornersOf(mesh.triangles).size() > 100);
  for (std::size_t t = 0; t < mesh.tier0Count(); ++t)
    for (const auto& at : mesh.match) CHECK(twiceArea(at, mesh.triangles[t]) > 0);

  // Agreeing triangles reach the board's border with the board's depth, and no triangle spans board and wall.
  const double nearRho = 1 / kBoard, farRho = 1 / kWall;
  std::size_t across = 0, right = 0;
  std::vector<glm::uvec3> near, far;
  for (std::size_t t = 0; t < mesh.tier0Count(); ++t) {
    float low = 1e9f, high = 0;
    for (int k = 0; k < 3; ++k) {
      low = std::min(low, mesh.inverseDistance[mesh.triangles[t][k]]);
      high = std::max(high, mesh.inverseDistance[mesh.triangles[t][k]]);
    }
    across += double(high - low) > 0.5 * (nearRho - farRho);
    (double(low + high) > nearRho + farRho ? near : far).push_back(mesh.triangles[t]);
  }
  CHECK(across == 0);
  CHECK(near.size() > 20);
  CHECK(far.size() > 20);
  CHECK(shared(cornersOf(near), cornersOf(far)).empty());
  const double border = stage.cameras[0].intrinsics.cx + stage.cameras[0].intrinsics.fx * kRight / kBoard;
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    right += std::abs(double(mesh.match[0][v].x) - border) < 0.6 && double(mesh.inverseDistance[v]) > 0.8 * nearRho;
  CHECK(right >= 5);
}

TEST_CASE("building a cell's mesh is deterministic") {
  const Stage stage = makeStage({kTheWall, kTheBoard});
  const DenseMatch match = matchViews(stage.views, stage.points);
  const MorphMesh once = buildMesh(stage.cameras, stage.views, match).mesh;
  const MorphMesh again = buildMesh(stage.cameras, stage.views, match).mesh;
  CHECK(once.match == again.match);
  CHECK(once.triangles == again.triangles);
}

TEST_CASE("without depth edges nothing is cut, however steep the wall") {
  for (const bool slanted : {false, true}) {
    const Stage stage = makeStage({slanted ? kSlantedWall : kTheWall});
    const DenseMatch match = matchViews(stage.views, stage.points);
    const SilhouetteFinder finder(stage.views, match);
    const Grid grid = gridOver(match);
    REQUIRE(grid.triangles.size() == 12);
    // The depths of a triangle's corners differ as much on the slanted wall as between two surfaces.
    const auto steep = std::ranges::count_if(grid.triangles, [&](const glm::uvec3& t) {
      return finder.parallax(grid.frame[t.y], grid.depth[t.y], grid.depth[t.z]) > 2.5;
    });
    CHECK(steep == (slanted ? 12 : 0));
    const std::vector<bool> wanted(grid.triangles.size(), true);
    const Layers layers = cutAtSilhouettes(finder, grid.frame, grid.depth, grid.triangles, wanted);
    INFO("slanted: " << slanted);
    CHECK(layers.splits.empty());
    CHECK(layers.vertices.empty());
  }
}
