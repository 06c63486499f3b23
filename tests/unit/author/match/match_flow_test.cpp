// SPDX-License-Identifier: Apache-2.0
#include "author/match/match_flow.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "author/features/features.h"
#include "author/match/mesh_warp.h"
#include "author/mesh/mesh.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

std::vector<Camera> rig() {
  return {lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({0.4, 0, 0.05}, {0, 1, 0}),
          lookingAlong({0.15, 0.05, 0.35}, {0, 1, 0})};
}

SyntheticScene wall(const std::vector<Camera>& cameras) {
  SyntheticOptions options;
  options.cameras = cameras;
  options.planes = {{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.16}};
  options.samplesPerAxis = 3;
  return makeScene(options);
}

std::vector<MatchView> viewsOf(const std::vector<Camera>& cameras, const SyntheticScene& scene) {
  std::vector<MatchView> views;
  for (std::size_t i = 0; i < cameras.size(); ++i) views.push_back({cameras[i], scene.photographs[i]});
  return views;
}

// Returns the pixel at which `to` sees the wall's point that `from` sees at a pixel.
glm::dvec2 seenFrom(const Camera& from, glm::dvec2 pixel, const Camera& to) {
  const glm::dvec3 ray = from.pose.rotation * unproject(from.intrinsics, pixel);
  const glm::dvec3 point = from.pose.position + ray * ((5 - from.pose.position.y) / ray.y);
  return *project(to.intrinsics, glm::inverse(to.pose.rotation) * (point - to.pose.position));
}

double shareGood(const DenseMatch& match) {
  return double(std::ranges::count(match.good.values, 1)) / double(match.good.values.size());
}

}  // namespace

TEST_CASE("flow matches a wall without poses, in any order of the members") {
  std::vector<Camera> cameras = rig();
  const SyntheticScene scene = wall(cameras);
  std::vector<MatchView> views = viewsOf(cameras, scene);
  std::vector<std::size_t> order = GENERATE(std::vector<std::size_t>{0, 1, 2}, std::vector<std::size_t>{2, 0, 1});
  std::vector<MatchView> ordered;
  for (const std::size_t i : order) {
    ordered.push_back(views[i]);
    ordered.back().camera.pose = {};  // flow does not use poses
  }
  const DenseMatch match = matchByFlow(ordered);
  CHECK(shareGood(match) > 0.5);
  std::size_t near = 0, all = 0;
  for (int y = 0; y < match.good.height; y += 3)
    for (int x = 0; x < match.good.width; x += 3) {
      if (!match.good.pixel(x, y)[0]) continue;
      double worst = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto at = match.position[i].pixel(x, y);
        worst = std::max(worst, glm::distance(glm::dvec2(at[0], at[1]),
                                              seenFrom(cameras[order[0]], {x + 0.5, y + 0.5}, cameras[order[i]])));
      }
      ++all;
      near += worst < 0.5;
    }
  CHECK(double(near) > 0.95 * double(all));
  const DenseMatch again = matchByFlow(ordered);
  CHECK(again.good == match.good);
  CHECK(again.position == match.position);
}

TEST_CASE("with poses, the flow's matches have their depth and give a valid mesh") {
  const std::vector<Camera> cameras = rig();
  const std::vector<MatchView> views = viewsOf(cameras, wall(cameras));
  const DenseMatch match = matchByFlow(views);
  const CellMesh cell = buildMesh(cameras, views, match);
  REQUIRE(cell.mesh.vertexCount() > 20);
  CHECK(cell.quality.coverage > 0.5);
  CHECK(cell.quality.residualPx < 0.3);
  std::size_t right = 0;
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    double mean = 0;
    const glm::dvec3 ray = cameras[0].pose.rotation * unproject(cameras[0].intrinsics, cell.mesh.match[0][p]);
    for (const Camera& c : cameras) mean += glm::distance(ray * (5 / ray.y), c.pose.position) / 3;
    right += std::abs(double(cell.mesh.inverseDistance[p]) * mean - 1) < 0.05;
  }
  CHECK(double(right) > 0.9 * double(cell.mesh.vertexCount()));
}

TEST_CASE("two equal images match everywhere, unrelated images match nowhere") {
  const std::vector<Camera> cameras = rig();
  std::vector<MatchView> views = viewsOf(cameras, wall(cameras));
  views.pop_back();
  views[1] = views[0];
  const DenseMatch same = matchByFlow(views);
  CHECK(shareGood(same) > 0.95);
  double worst = 0;
  for (std::size_t p = 0; p < same.good.values.size(); ++p)
    if (same.good.values[p])
      for (std::size_t c = 0; c < 2; ++c)
        worst =
            std::max(worst, double(std::abs(same.position[1].values[2 * p + c] - same.position[0].values[2 * p + c])));
  CHECK(worst < 0.05);
  CHECK(std::ranges::all_of(same.inverseDepth.values, [](float w) { return w == 0; }));

  std::mt19937 random(3);
  for (std::uint8_t& value : views[1].picture.values) value = std::uint8_t(random() & 255);
  CHECK(shareGood(matchByFlow(views)) < 0.05);
}

TEST_CASE("flat and tiny images are matched without a crash") {
  const std::vector<Camera> cameras = rig();
  for (const glm::ivec2 size : {glm::ivec2(200, 150), glm::ivec2(20, 15), glm::ivec2(1, 1)}) {
    std::vector<MatchView> views;
    for (Camera camera : cameras) {
      camera.intrinsics = resized(camera.intrinsics, size.x, size.y);
      views.push_back({camera, Image8(size.x, size.y, 3, 90)});
    }
    const DenseMatch match = matchByFlow(views);
    CHECK(match.position.size() == 3);
    const CellMesh cell = buildMesh(cameras, views, match);
    for (const float rho : cell.mesh.inverseDistance) CHECK(std::isfinite(rho));
  }
}

TEST_CASE("features are spread, grouped by position, and match themselves") {
  const SyntheticScene scene = wall(rig());
  Image8 grey(200, 150, 1);
  for (std::size_t p = 0; p < grey.values.size(); ++p) grey.values[p] = scene.photographs[0].values[3 * p];
  const Features features = detectFeatures(grey, 400);
  CHECK(features.count() > 80);
  CHECK(features.count() <= 600);
  CHECK(features.first.size() == features.count() + 1);
  CHECK(features.first.back() == features.descriptor.size());
  for (std::size_t f = 1; f < features.count(); ++f) CHECK(features.at[f] != features.at[f - 1]);
  const std::vector<FeatureMatch> own = mutualMatches(features, features, 0.99);
  CHECK(own.size() > features.count() / 2);
  for (const FeatureMatch& m : own) {
    CHECK(m.a == m.b);
    CHECK(m.distance == 0);
  }
  const std::vector<bool> taken(features.count(), true);
  CHECK(mutualMatches(features, features, 0.99, taken).empty());
  CHECK(mutualMatches(features, features, 0.99, {}, taken).empty());
  CHECK(detectFeatures(Image8(200, 150, 1, 7), 400).count() == 0);
  CHECK(detectFeatures(Image8(3, 2, 1, 7), 400).count() == 0);
}

TEST_CASE("a mesh warp follows a homography and a foreground object, and ignores outliers") {
  const auto plane = [](glm::vec2 p) { return glm::vec2(1.1f * p.x + 0.1f * p.y + 5, 0.95f * p.y + 3); };
  PointPairs pairs;
  std::mt19937 random(5);
  for (int y = 5; y < 150; y += 12)
    for (int x = 5; x < 200; x += 12) {
      const glm::vec2 at(x, y);
      pairs.from.push_back(at);
      pairs.to.push_back(plane(at) + (x > 60 && x < 120 && y > 40 && y < 100 ? glm::vec2(9, 0) : glm::vec2(0)));
    }
  for (int k = 0; k < 40; ++k) {
    pairs.from.emplace_back(random() % 200, random() % 150);
    pairs.to.emplace_back(random() % 200, random() % 150);
  }
  const ImageF map = meshWarp(pairs, {200, 150}, {200, 150});
  const auto off = [&](int x, int y, glm::vec2 shift) {
    const auto at = map.pixel(x, y);
    return glm::distance(glm::vec2(at[0], at[1]), plane({float(x) + 0.5f, float(y) + 0.5f}) + shift);
  };
  CHECK(off(20, 20, {0, 0}) < 0.5f);
  CHECK(off(180, 130, {0, 0}) < 0.5f);
  CHECK(off(90, 70, {9, 0}) < 0.5f);
  const ImageF none = meshWarp({}, {10, 10}, {20, 30});
  CHECK(none.pixel(0, 0)[0] == Approx(1));
  CHECK(none.pixel(9, 9)[1] == Approx(28.5));
}
