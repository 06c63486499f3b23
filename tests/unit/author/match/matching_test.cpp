// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "author/cgal/delaunay.h"
#include "author/geometry/mean_frame.h"
#include "author/match/match.h"
#include "author/match/quadtree.h"
#include "author/mesh/mesh.h"
#include "author/sweep/depth_clean.h"
#include "author/sweep/plane_sweep.h"
#include "author/sweep/sgm.h"
#include "author/sweep/visibility.h"
#include "ibr/error.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// A wall, a board in front of its left half, and three cameras.
struct Stage {
  SyntheticScene scene;
  std::vector<MatchView> views;
  std::vector<Camera> cameras;
  std::vector<glm::dvec3> points;
};
Stage makeStage(bool board = true) {
  Stage stage;
  stage.cameras = {lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({0.4, 0, 0.05}, {0, 1, 0}),
                   lookingAlong({0.15, 0.05, 0.35}, {0, 1, 0})};
  SyntheticOptions options;
  options.cameras = stage.cameras;
  options.planes = {{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.16}};
  if (board) options.planes.push_back({{-0.6, 2.6, 0.1}, {1, 0, 0}, {0, 0, 1}, 1.2, 1.2, 2, 0.08});
  options.samplesPerAxis = 3;
  stage.scene = makeScene(options);
  for (std::size_t i = 0; i < 3; ++i) stage.views.push_back({stage.cameras[i], stage.scene.photographs[i]});
  for (int i = 0; i < 50; ++i) stage.points.emplace_back(-1 + 0.05 * i, i % 2 && board ? 2.6 : 5.0, 0.02 * i - 0.5);
  return stage;
}

// Returns the point of the scene that member 0 sees at a pixel; nullopt if there is none.
std::optional<glm::dvec3> truthPoint(const Stage& stage, const ImageF& depth, glm::dvec2 pixel) {
  const double z = depth.pixel(int(pixel.x), int(pixel.y))[0];
  if (!std::isfinite(z)) return std::nullopt;
  const glm::dvec3 ray = unproject(stage.cameras[0].intrinsics, pixel);
  return stage.cameras[0].pose.position + stage.cameras[0].pose.rotation * (ray * (z / -ray.z));
}

// Returns true if a depth edge lies within 2 px.
bool nearDepthEdge(const ImageF& depth, glm::vec2 pixel) {
  float low = std::numeric_limits<float>::infinity(), high = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const float z = depth.pixel(std::clamp(int(pixel.x) + dx, 0, depth.width - 1),
                                  std::clamp(int(pixel.y) + dy, 0, depth.height - 1))[0];
      low = std::min(low, z);
      high = std::max(high, z);
    }
  return high > 1.5f * low;
}

double signedArea(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
  return (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
}

}  // namespace

TEST_CASE("two planes are matched to a third of a pixel, and the mesh is valid") {
  const Stage stage = makeStage();
  const bool refine = GENERATE(false, true);
  const DenseMatch match = matchViews(stage.views, stage.points, {refine});
  const CellMesh cell = buildMesh(stage.cameras, stage.views, match);
  const MorphMesh& mesh = cell.mesh;
  REQUIRE(mesh.vertexCount() > 100);

  Scene scene;
  for (std::size_t i = 0; i < 3; ++i) scene.nodes.push_back({std::to_string(i), stage.cameras[i], {}, {}});
  scene.cells.push_back({{0, 1, 2}, mesh, cell.quality});
  for (const Fault& fault : validate(scene)) FAIL_CHECK(fault.field << " " << fault.message);

  const ImageF depth = renderDepth(stage.scene, stage.cameras[0]);
  std::size_t good = 0, rangeGood = 0, known = 0;
  std::set<std::size_t> agreed;
  for (std::size_t t = 0; t < mesh.tier0Count(); ++t)
    for (int k = 0; k < 3; ++k) agreed.insert(mesh.triangles[t][k]);
  for (const std::size_t p : agreed) {
    if (nearDepthEdge(depth, mesh.match[0][p])) continue;  // both depths are right at an edge
    const auto point = truthPoint(stage, depth, mesh.match[0][p]);
    if (!point) continue;
    ++known;
    double worst = 0, mean = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto pixel = project(stage.cameras[i].intrinsics, glm::inverse(stage.cameras[i].pose.rotation) *
                                                                  (*point - stage.cameras[i].pose.position));
      worst = std::max(worst, pixel ? glm::distance(*pixel, glm::dvec2(mesh.match[i][p])) : 1e9);
      mean += glm::distance(*point, stage.cameras[i].pose.position) / 3;
    }
    good += worst < 0.3;
    rangeGood += std::abs(double(mesh.inverseDistance[p]) * mean - 1) < 0.05;
  }
  REQUIRE(double(known) > 0.7 * double(agreed.size()));
  CHECK(double(good) > 0.8 * double(known));
  CHECK(double(rangeGood) > 0.9 * double(known));

  const std::size_t tier0 = mesh.tier0Count();
  CHECK(tier0 > 100);
  CHECK(tier0 < mesh.triangles.size());  // rejected triangles across the board's edge are stored too
  CHECK(std::is_sorted(mesh.tier.begin(), mesh.tier.end()));
  for (std::size_t t = 0; t < tier0; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::uvec3 v = mesh.triangles[t];
      CHECK(signedArea(mesh.match[i][v.x], mesh.match[i][v.y], mesh.match[i][v.z]) > 0);
    }
  CHECK(cell.quality.coverage > 0.5);
  CHECK(cell.quality.coverage < 1.0);
  CHECK(cell.quality.ecc > 0.9);
  CHECK(cell.quality.residualPx < 0.3);
}

TEST_CASE("the frame takes its members' depth, and rejects pixels where an unmasked member contradicts") {
  Stage stage = makeStage(false);
  std::vector<MemberDepth> depths;
  for (const Camera& camera : stage.cameras) {
    depths.push_back({camera, renderDepth(stage.scene, camera), 0.01});
    for (float& depth : depths.back().inverseDepth.values) depth = std::isfinite(depth) ? 1 / depth : -1;
  }
  const auto goodShare = [&] {
    const DenseMatch match = matchViews(stage.views, stage.points, {false, depths});
    const std::size_t pixels = match.good.values.size();
    for (std::size_t p = 0; p < pixels; ++p)
      if (match.good.values[p])
        CHECK(match.inverseDepth.values[p] ==
              Approx(inverseDepth(match.frame, {match.frame.pose.position.x, 5, 0})).epsilon(1e-3));
    return double(std::ranges::count(match.good.values, 1)) / double(pixels);
  };
  CHECK(goodShare() > 0.6);
  for (float& depth : depths[2].inverseDepth.values) depth *= 2;
  CHECK(goodShare() == 0);
  stage.views[2].mask = Image8(stage.views[2].picture.width, stage.views[2].picture.height, 1, 0);
  CHECK(goodShare() > 0.6);
}

TEST_CASE("views smaller than the stored photographs give matches in stored pixels") {
  const Stage stage = makeStage(false);
  std::vector<Camera> stored = stage.cameras;
  for (Camera& camera : stored) camera.intrinsics = resized(camera.intrinsics, 800, 600);
  const DenseMatch match = matchViews(stage.views, stage.points);
  const CellMesh small = buildMesh(stage.cameras, stage.views, match), large = buildMesh(stored, stage.views, match);
  REQUIRE(small.mesh.vertexCount() == large.mesh.vertexCount());
  for (std::size_t p = 0; p < small.mesh.vertexCount(); ++p) {
    CHECK(glm::distance(4.0f * small.mesh.match[1][p], large.mesh.match[1][p]) < 7.1f / 1024);  // both on the grid
    CHECK(small.mesh.inverseDistance[p] == Approx(large.mesh.inverseDistance[p]));
  }
}

TEST_CASE("unrelated photographs do not agree") {
  Stage stage = makeStage(false);
  stage.views[1].picture = makeStage(true).scene.photographs[0];
  std::mt19937 random(4);
  for (std::uint8_t& value : stage.views[1].picture.values) value = std::uint8_t(random() & 255);
  const CellMesh cell = buildMesh(stage.cameras, stage.views, matchViews(stage.views, stage.points));
  CHECK(cell.quality.coverage < 0.05);
}

TEST_CASE("a cell without a point in front of it is rejected, flat and tiny images are not") {
  Stage stage = makeStage(false);
  const std::vector<glm::dvec3> behind{{0, -5, 0}};
  CHECK_THROWS_AS(matchViews(stage.views, behind), Error);
  CHECK_THROWS_AS(matchViews(stage.views, {}), Error);
  for (MatchView& view : stage.views)
    std::fill(view.picture.values.begin(), view.picture.values.end(), std::uint8_t(255));
  const CellMesh flat = buildMesh(stage.cameras, stage.views, matchViews(stage.views, stage.points, {true}));
  for (const float ecc : flat.mesh.ecc) CHECK(std::isfinite(ecc));

  for (MatchView& view : stage.views) {
    view.camera.intrinsics = resized(view.camera.intrinsics, 3, 2);
    view.picture = Image8(3, 2, 3, 100);
  }
  std::vector<Camera> cameras;
  for (const MatchView& view : stage.views) cameras.push_back(view.camera);
  CHECK_NOTHROW(buildMesh(cameras, stage.views, matchViews(stage.views, stage.points, {true})));
}

TEST_CASE("levels of the sweep reach from infinity to in front of the nearest tracks") {
  const Stage stage = makeStage(false);
  const Camera frame = meanFrame(stage.cameras);
  const std::vector<double> compact(100, 0.2);
  std::vector<double> wide;
  for (int i = 0; i < 100; ++i) wide.push_back(0.002 + 0.005 * i);
  for (const auto& tracks : {compact, wide}) {
    const SweepLevels levels = sweepLevels(frame, stage.cameras, tracks);
    CHECK(levels.inverseDepth.front() == 0);
    CHECK(levels.inverseDepth.back() >= 1.3 * tracks.back());
    CHECK(std::is_sorted(levels.inverseDepth.begin(), levels.inverseDepth.end()));
    CHECK(levels.at(0) == 0);
    CHECK(levels.at(levels.count() - 1) == Approx(levels.inverseDepth.back()));
    CHECK(levels.at(levels.count() - 1.5) == Approx(levels.inverseDepth.back() - 0.5 * levels.step));
    CHECK(levels.count() > 60);
    CHECK(levels.count() < 300);
  }
}

TEST_CASE("the sweep's cost is minimal at the true depth") {
  const Stage stage = makeStage(false);
  std::vector<SweepView> views;
  for (const MatchView& view : stage.views) {
    views.push_back({view.camera, ImageF(view.picture.width, view.picture.height, 1)});
    for (std::size_t p = 0; p < views.back().grey.values.size(); ++p)
      views.back().grey.values[p] = view.picture.values[3 * p + 1];
  }
  const Camera frame = meanFrame(stage.cameras);
  const SweepLevels levels = sweepLevels(frame, stage.cameras, std::vector<double>(50, 0.2));
  const CostVolume volume = planeSweep(frame, views, levels);
  const ImageF level = semiGlobalMatch(volume).level;
  const double truth = 1 / (5.0 - frame.pose.position.y);
  std::size_t right = 0, all = 0;
  for (int y = 30; y < 100; ++y)
    for (int x = 30; x < 150; ++x, ++all)
      right += std::abs(levels.at(double(level.pixel(x, y)[0])) - truth) < levels.step;
  CHECK(double(right) > 0.98 * double(all));
}

TEST_CASE("semi-global matching fills regions without texture from their surroundings") {
  CostVolume volume{40, 30, 20, std::vector<std::uint8_t>(40 * 30 * 20, 60), ImageF(40, 30, 1, 100.0f)};
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      if (x < 12 || x > 28) volume.cost[std::size_t((y * 40 + x) * 20 + 13)] = 5;
  const ImageF level = semiGlobalMatch(volume).level;
  for (const float l : level.values) CHECK(l == Approx(13).margin(0.01));
}

TEST_CASE("speckles are filled from the farther side, and slanted surfaces are unchanged") {
  ImageF map(60, 40, 1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) map.pixel(x, y)[0] = x < 30 ? 10.0f : 50.0f;
  for (int y = 10; y < 16; ++y)
    for (int x = 24; x < 30; ++x) map.pixel(x, y)[0] = 90.0f;
  cleanDepth(map, 2.0f, 60);
  for (int y = 10; y < 16; ++y) CHECK(map.pixel(26, y)[0] == 10.0f);
  CHECK(map.pixel(40, 12)[0] == 50.0f);

  ImageF slope(60, 40, 1), noisy(60, 40, 1);
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.25f);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      slope.pixel(x, y)[0] = 20.0f + 0.5f * float(x) + 1.1f * float(y);
      noisy.pixel(x, y)[0] = slope.pixel(x, y)[0] + noise(random);
    }
  const ImageF exact = enlarged(fitPlanes(slope, 1.0f), 120, 80), smooth = enlarged(fitPlanes(noisy, 1.0f), 60, 40);
  float off = 0;
  double before = 0, after = 0;
  for (int y = 4; y < 36; ++y)
    for (int x = 4; x < 56; ++x) {
      off = std::max(off, std::abs(exact.pixel(2 * x, 2 * y)[0] - (slope.pixel(x, y)[0] - 0.25f * 1.6f)));
      before += std::pow(noisy.pixel(x, y)[0] - slope.pixel(x, y)[0], 2);
      after += std::pow(smooth.pixel(x, y)[0] - slope.pixel(x, y)[0], 2);
    }
  CHECK(off < 7.1f / 1024);  // both matches are snapped to the grid
  CHECK(after < 0.2 * before);
}

TEST_CASE("a member sees neither points behind a solid surface nor points outside its image") {
  const Camera frame = lookingAlong({0, 0, 0}, {0, 1, 0}, 100, 80),
               member = lookingAlong({0.5, 0, 0}, {0, 1, 0}, 100, 80);
  ImageF depth(100, 80, 1, 0.1f);  // wall at 10 units, post at 2 units
  Image8 solid(100, 80, 1, 1);
  for (int y = 0; y < 80; ++y)
    for (int x = 45; x < 55; ++x) depth.pixel(x, y)[0] = 0.5f;
  const FrameToMember map = frameToMember(frame, member);
  const Image8 visible = visibleFrom(map, depth, solid, 100, 80, 0.02f);
  // The post shifts left by f·0.5/2 px, the wall by f·0.5/10 px.
  const double focal = frame.intrinsics.fx;
  const int hidden = int(50 - focal * 0.5 * 0.5 + focal * 0.5 * 0.1);
  CHECK(visible.pixel(50, 40)[0] == 1);
  CHECK(visible.pixel(hidden, 40)[0] == 0);
  CHECK(visible.pixel(hidden + 15, 40)[0] == 1);
  CHECK(visible.pixel(1, 40)[0] == 0);
  for (int y = 0; y < 80; ++y)
    for (int x = 45; x < 55; ++x) solid.pixel(x, y)[0] = 0;
  CHECK(visibleFrom(map, depth, solid, 100, 80, 0.02f).pixel(hidden, 40)[0] == 1);
}

TEST_CASE("the quadtree is coarse where the match is affine, fine at its edges, and empty where nothing matches") {
  DenseMatch match;
  match.good = Image8(128, 96, 1, 1);
  match.position.assign(2, ImageF(128, 96, 2));
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 128; ++x) {
      match.position[0].pixel(x, y)[0] = 0.5f + 1.1f * float(x);
      match.position[0].pixel(x, y)[1] = float(y) - 3.0f + 0.2f * float(x);
      match.position[1] = match.position[0];
    }
  CHECK(meshVertices(match.good, match.position).size() == 12);
  for (int y = 0; y < 96; ++y) match.position[1].pixel(70, y)[0] += 9.0f;
  const auto fine = meshVertices(match.good, match.position);
  CHECK(fine.size() > 24);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 128; ++x) match.good.pixel(x, y)[0] = x < 50;
  const auto half = meshVertices(match.good, match.position);
  CHECK_FALSE(half.empty());
  for (const glm::ivec2 v : half) CHECK(v.x < 50);
  std::fill(match.good.values.begin(), match.good.values.end(), std::uint8_t(0));
  CHECK(meshVertices(match.good, match.position).empty());
}

TEST_CASE("Delaunay triangulations handle duplicates and degenerate input") {
  CHECK(delaunayTriangles({}).empty());
  CHECK(delaunayTriangles(std::vector<glm::dvec2>{{0, 0}, {1, 1}, {2, 2}, {3, 3}}).empty());
  CHECK(delaunayTetrahedra(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}).empty());
  const std::vector<glm::dvec2> square{{0, 0}, {1, 0}, {0, 0}, {1, 1}, {0, 1}};
  const auto triangles = delaunayTriangles(square);
  REQUIRE(triangles.size() == 2);
  for (const glm::uvec3& t : triangles) {
    CHECK(t.x != 2);
    CHECK(t.y != 2);
    CHECK(t.z != 2);
    CHECK(signedArea(square[t.x], square[t.y], square[t.z]) > 0);
  }
  std::vector<glm::dvec3> grid;
  for (int i = 0; i < 27; ++i) grid.emplace_back(i % 3, i / 3 % 3, i / 9);
  double volume = 0;
  for (const glm::uvec4& t : delaunayTetrahedra(grid))
    volume += std::abs(glm::dot(glm::cross(grid[t.y] - grid[t.x], grid[t.z] - grid[t.x]), grid[t.w] - grid[t.x])) / 6;
  CHECK(volume == Approx(8));
}
