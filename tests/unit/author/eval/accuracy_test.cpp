// SPDX-License-Identifier: Apache-2.0
#include "ibr/lab/accuracy.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/error.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Returns a scene of one cell: a wall, and a board in front of a part of the wall.
SyntheticScene wallAndBoard(std::size_t members, bool atInfinity = false) {
  SyntheticOptions options;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {0.6, 0, 0}, {0.3, 0, 0.5}, {0.3, 0.4, 0.2}})
    options.cameras.push_back(lookingAlong(place, {0, 1, 0}));
  options.cameras.resize(members);
  options.planes = {{{0.5, 6, 0}, {1, 0, 0}, {0, 0, 1}, 30, 20, 1, 0.3}};
  if (!atInfinity) options.planes.push_back({{0.2, 3, 0.1}, {1, 0, 0}, {0, 0, 1}, 0.8, 0.6, 2, 0.2});
  options.gridStep = 8;
  options.atInfinity = atInfinity;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

std::vector<ExactDepthView> depthAround(const SyntheticScene& made) {
  std::vector<ExactDepthView> views;
  for (const double x : {0.0, 0.2, 0.4, 0.6}) {
    const Camera camera = lookingAlong({x, -0.2, 0.2 * x}, {0.1 * x, 1, 0}, 500, 375, 1.1);
    ImageF depth = renderDepth(made, camera);
    for (float& d : depth.values) d = std::isfinite(d) ? d : 0.0f;
    views.push_back({camera, std::move(depth)});
  }
  return views;
}

double largest(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

}  // namespace

TEST_CASE("exact matches have no error") {
  const std::size_t members = GENERATE(2u, 3u, 4u);
  const bool atInfinity = GENERATE(false, true);
  const SyntheticScene made = wallAndBoard(members, atInfinity);
  const auto result = matchAccuracy(made.scene, depthAround(made));
  REQUIRE(result.size() == 1);
  const MatchAccuracy& a = result[0];
  CHECK(a.vertexErrorsPx.size() > 200);
  CHECK(largest(a.vertexErrorsPx) < 0.02);
  CHECK(a.coVisible > 15000);
  CHECK(a.coVisibleTier0 > 0.8 * a.coVisible);
  CHECK(a.correctTier0 == a.tier0);
  CHECK(a.correct == a.tier0);
  CHECK(a.folded == 0);
}

TEST_CASE("errors of matches and labels are counted") {
  SyntheticScene made = wallAndBoard(3);
  MorphMesh& mesh = made.scene.cells[0].mesh;
  const auto truth = depthAround(made);
  const MatchAccuracy before = matchAccuracy(made.scene, truth)[0];

  SECTION("matches are shifted by 2 px in one member") {
    for (glm::vec2& p : mesh.match[2]) p.x += 2;
    const MatchAccuracy a = matchAccuracy(made.scene, truth)[0];
    CHECK(a.vertexErrorsPx.size() == before.vertexErrorsPx.size());
    for (const double error : a.vertexErrorsPx) CHECK(error == Approx(2.0).margin(0.02));
    CHECK(a.correctTier0 == 0);
    CHECK(a.coVisibleTier0 == before.coVisibleTier0);
  }
  SECTION("half of the correct triangles are in tier 1") {
    const std::size_t half = mesh.triangles.size() / 2;
    for (std::size_t t = half; t < mesh.tier.size(); ++t) mesh.tier[t] = kTierRejected;
    const MatchAccuracy a = matchAccuracy(made.scene, truth)[0];
    CHECK(a.correctTier0 == a.tier0);
    CHECK(a.correct == before.correct);
    CHECK(a.tier0 < 0.8 * before.tier0);
    CHECK(a.coVisibleTier0 < before.coVisibleTier0);
    CHECK(a.coVisible == before.coVisible);
  }
  SECTION("a triangle is flipped") {
    // Mirroring a vertex across the opposite edge in one member flips at least that triangle.
    const glm::uvec3 t = mesh.triangles[mesh.triangles.size() / 2];
    auto& at = mesh.match[1];
    at[t.x] = at[t.y] + at[t.z] - at[t.x];
    CHECK(matchAccuracy(made.scene, truth)[0].folded >= 1);
  }
  SECTION("triangles bridge wall and board") {
    // The board's vertices are moved onto the wall; the matches then lie on wall that the board hides.
    const Camera& first = made.scene.nodes[0].camera;
    std::size_t moved = 0;
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
      const glm::dvec3 ray = first.pose.rotation * unproject(first.intrinsics, mesh.match[0][v]);
      const double s = mesh.ratio[0][v] / mesh.inverseDistance[v];
      if (std::abs(s * ray.y - 3) > 0.1) continue;
      const glm::dvec3 wall = ray * (6.0 / ray.y);
      for (std::size_t i = 1; i < 3; ++i) {
        const Camera& camera = made.scene.nodes[i].camera;
        mesh.match[i][v] =
            *project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (wall - camera.pose.position));
      }
      ++moved;
    }
    REQUIRE(moved > 10);
    const MatchAccuracy a = matchAccuracy(made.scene, truth)[0];
    CHECK(std::ranges::count_if(a.vertexErrorsPx, [](double e) { return e > 3; }) > 10);
    CHECK(a.correctTier0 < before.correctTier0);
  }
}

TEST_CASE("the uncertainty of a vertex is compared with its error") {
  SyntheticScene made = wallAndBoard(2);
  MorphMesh& mesh = made.scene.cells[0].mesh;
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
    mesh.uncertainty[v] = 0.01f * mesh.inverseDistance[v];
    mesh.inverseDistance[v] *= 1.015f;
  }
  const MatchAccuracy a = matchAccuracy(made.scene, depthAround(made))[0];
  CHECK(std::ranges::all_of(a.deviation, [](double d) { return d == Approx(1.5).margin(0.05); }));
}

TEST_CASE("depth that does not fit its view is rejected") {
  const SyntheticScene made = wallAndBoard(2);
  auto views = depthAround(made);
  views[1].depth = ImageF(10, 10, 1);
  CHECK_THROWS_AS(matchAccuracy(made.scene, views), Error);
  views[1].camera.intrinsics = {CameraModel::equirectangular, 10, 10};
  CHECK_THROWS_AS(matchAccuracy(made.scene, views), Error);
}

TEST_CASE("disturbed matches are set back to their exact positions") {
  SyntheticScene made = wallAndBoard(3);
  const auto truth = depthAround(made);
  const MorphMesh exact = made.scene.cells[0].mesh;
  MorphMesh& mesh = made.scene.cells[0].mesh;
  for (std::size_t p = 0; p < mesh.vertexCount(); p += 3) {
    mesh.match[1][p] += glm::vec2(0.5, -0.25);
    mesh.ratio[0][p] *= 1.1f;
    mesh.inverseDistance[p] *= 0.9f;
  }
  const MorphMesh disturbed = mesh;
  const std::size_t moved = setExactMatches(made.scene, truth, {});
  CHECK(moved > exact.vertexCount() / 2);
  CHECK(largest(matchAccuracy(made.scene, truth)[0].vertexErrorsPx) < 0.75);
  std::size_t right = 0;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    CHECK(glm::distance(mesh.match[0][p], exact.match[0][p]) < 0.01f);
    if (glm::distance(mesh.match[1][p], exact.match[1][p]) > 0.02f) continue;
    if (mesh.ratio[0][p] != Approx(exact.ratio[0][p]).epsilon(1e-3)) continue;
    right += mesh.inverseDistance[p] == Approx(exact.inverseDistance[p]).epsilon(1e-3);
  }
  CHECK(right >= moved);
  std::size_t back = 0, disturbedPoints = 0;
  for (std::size_t p = 0; p < mesh.vertexCount(); p += 3, ++disturbedPoints)
    back += glm::distance(mesh.match[1][p], exact.match[1][p]) < 0.02f;
  CHECK(back > disturbedPoints / 2);
  CHECK(made.scene.settings.find(R"("exactMatches":{"within":4.0,"noise":0.0,"seed":1})") != std::string::npos);
  CHECK(mesh.triangles == disturbed.triangles);
  CHECK(mesh.uncertainty == disturbed.uncertainty);
}

TEST_CASE("matches on another surface stay") {
  SyntheticScene made = wallAndBoard(3);
  MorphMesh& mesh = made.scene.cells[0].mesh;
  for (glm::vec2& at : mesh.match[2]) at.x += 5;
  const MorphMesh before = mesh;
  CHECK(setExactMatches(made.scene, depthAround(made), {}) == 0);
  CHECK(mesh.match == before.match);
  CHECK(setExactMatches(made.scene, depthAround(made), {.maxErrorPx = 6}) > 100);
}

TEST_CASE("noise on exact matches is uniform, depends on the seed, and flips no triangle") {
  const SyntheticScene made = wallAndBoard(3);
  const auto truth = depthAround(made);
  const auto disturbed = [&](double noisePx, std::uint64_t seed, int threads) {
    Scene scene = made.scene;
    setExactMatches(scene, truth, {.noisePx = noisePx, .seed = seed}, threads);
    return scene;
  };
  const Scene scene = disturbed(3, 1, 1);
  const MorphMesh &mesh = scene.cells[0].mesh, &exact = made.scene.cells[0].mesh;
  double sum = 0, squares = 0, count = 0;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p)
    for (const float off : {mesh.match[1][p].x - exact.match[1][p].x, mesh.match[2][p].y - exact.match[2][p].y}) {
      CHECK(std::abs(off) < 3.02f);
      if (off == 0) continue;
      sum += off, squares += off * off, ++count;
    }
  REQUIRE(count > 400);
  CHECK(std::abs(sum / count) < 0.2);
  CHECK(std::sqrt(squares / count) == Approx(std::sqrt(3.0)).epsilon(0.1));  // 3 px/√3
  CHECK(matchAccuracy(scene, truth)[0].folded == 0);
  // ρ has errors, but few exceed three times the stated deviation.
  std::size_t off = 0, far = 0;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    const double error = std::abs(double(mesh.inverseDistance[p]) - double(exact.inverseDistance[p]));
    off += error > 0.002 * double(exact.inverseDistance[p]);
    far += error > 3 * double(mesh.uncertainty[p]) && mesh.match[1][p] != exact.match[1][p];
  }
  CHECK(off > 200);
  CHECK(far < mesh.vertexCount() / 20);
  CHECK(disturbed(3, 1, 2).cells[0].mesh.match == mesh.match);
  CHECK(disturbed(3, 2, 1).cells[0].mesh.match != mesh.match);
  CHECK(disturbed(20, 1, 1).cells[0].mesh.match[1] != mesh.match[1]);
  CHECK(matchAccuracy(disturbed(20, 1, 1), truth)[0].folded == 0);
}

TEST_CASE("invalid options of exact matches are rejected") {
  Scene scene = wallAndBoard(2).scene;
  const auto truth = depthAround(wallAndBoard(2));
  for (const ExactMatchOptions& wrong :
       {ExactMatchOptions{.maxErrorPx = 0}, {.maxErrorPx = NAN}, {.noisePx = -1}, {.noisePx = 65}, {.noisePx = NAN}})
    CHECK_THROWS_AS(setExactMatches(scene, truth, wrong), Error);
}
