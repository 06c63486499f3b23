// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_depth.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "scene/synth/synthetic.h"
#include "support/error_of.h"

using namespace ibr;

namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kDistance = 4;

// Photographs of a wall .5 apart, joined by exact cells but for the last one; a panorama stands among them.
SyntheticScene wall() {
  SyntheticOptions options;
  const auto add = [&](double x) {
    options.cameras.push_back({pinholeFromFov(kWidth, kHeight, 0.9), {{x, 0, 0}, {1, 0, 0, 0}}});
  };
  for (const double x : {0.0, 0.5, 1.0}) add(x);
  options.cameras.push_back({{CameraModel::equirectangular, 64, 32}, {{1.2, 0, 0}, {1, 0, 0, 0}}});
  for (const double x : {1.5, 2.0}) add(x);
  options.planes = {{.origin = {0, 0, -kDistance}, .extentU = 40, .extentV = 40, .wavelength = 1}};
  options.cells = {{0, 1}, {1, 2}, {2, 4}};
  options.gridStep = 8;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

float valueAt(const ImageF& map, int x, int y) {
  return map.pixel(x, y)[0];
}

CompletedDepth uniform(int width, int height) {
  return {{ImageF(width, height, 1, 0.25f), ImageF(width, height, 1, 0.5f)}, Image8(width, height, 1, 2)};
}

}  // namespace

TEST_CASE("each pinhole of a scene has the depth of its cells, and is confirmed by the others") {
  SyntheticScene made = wall();
  for (std::size_t c = 0; c < 3; ++c) made.scene.cells[c].quality.residualPx = double(c);
  const std::vector<PhotographDepth> depths = depthOfPhotographs(made.scene);
  REQUIRE(depths.size() == 5);
  const std::uint32_t nodes[]{0, 1, 2, 4, 5};
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(depths[i].node == nodes[i]);
    CHECK(depths[i].matched.map.camera.intrinsics.width == kWidth);
    // 2 px of a photograph at the median spacing of the pinholes, .5; the panorama does not count.
    CHECK(depths[i].matched.step == Approx(2 / (made.scene.nodes[0].camera.intrinsics.fx * 0.5)));
    CHECK(depths[i].matched.residualPx == Approx(1));
  }
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(valueAt(depths[i].matched.map.inverseDepth, kWidth / 2, kHeight / 2) == Approx(1 / kDistance).epsilon(1e-3));
  CHECK(int(depths[1].evidence.confirmations.pixel(kWidth / 2, kHeight / 2)[0]) == 3);
  CHECK(std::ranges::all_of(depths[4].matched.map.inverseDepth.values, [](float w) { return w == kUnknownDepth; }));
}

TEST_CASE("a photograph that no cell has takes the depth of its points") {
  const SyntheticScene made = wall();
  std::vector<std::uint32_t> asked;
  const std::vector<PhotographDepth> depths = depthOfPhotographs(made.scene, {.points = [&](std::uint32_t node) {
                                                                   asked.push_back(node);
                                                                   return std::vector<glm::dvec3>{{2, 0, -5}};
                                                                 }});
  CHECK(asked == std::vector<std::uint32_t>{5});
  CHECK(valueAt(depths[4].matched.map.inverseDepth, kWidth / 2, kHeight / 2) == Approx(0.2));
  CHECK(std::ranges::count_if(depths[4].matched.map.inverseDepth.values, [](float w) { return w >= 0; }) == 1);
}

TEST_CASE("depth does not depend on the order of its jobs, and a runner may stop it") {
  const SyntheticScene made = wall();
  const JobRunner backwards = [](std::size_t count, const std::function<void(std::size_t)>& job) {
    for (std::size_t i = count; i-- > 0;) job(i);
  };
  const auto one = depthOfPhotographs(made.scene),
             two = depthOfPhotographs(made.scene, {.depths = backwards, .evidence = backwards});
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(one[i].matched.map.inverseDepth == two[i].matched.map.inverseDepth);
    CHECK(one[i].evidence.confirmations == two[i].evidence.confirmations);
    CHECK(one[i].evidence.contradictions == two[i].evidence.contradictions);
  }
  const JobRunner stops = [](std::size_t, const auto&) { throw Error(ErrorCode::cancelled, "stopped"); };
  for (const PhotographDepthOptions& options :
       {PhotographDepthOptions{.depths = stops}, PhotographDepthOptions{.evidence = stops}})
    CHECK(test::errorOf([&] { depthOfPhotographs(made.scene, options); }).code() == ErrorCode::cancelled);
}

TEST_CASE("a scene without pinholes has no depth of photographs") {
  CHECK(depthOfPhotographs({}).empty());
  CHECK(medianResidualPx({}) == 0);
}

TEST_CASE("completed depth keeps what was matched, and has no confirmations elsewhere") {
  PhotographDepth depth;
  depth.matched.map.inverseDepth = ImageF(4, 1, 1, 0.5f);
  depth.matched.map.inverseDepth.values[3] = kUnknownDepth;
  depth.evidence = {Image8(4, 1, 1), Image8(4, 1, 1)};
  depth.evidence.confirmations.values = {0, 3, 1, 7};
  depth.evidence.contradictions.values = {0, 0, 2, 0};
  const CompletedDepth whole = completed(depth, Image8(4, 1, 3, 90));
  for (const float rho : whole.maps.inverseDepth.values) CHECK(rho == Approx(0.5));
  CHECK(whole.confirmations.values == std::vector<std::uint8_t>{0, 3, 1, 0});
  CHECK(whole.maps.consensus.values == std::vector<float>{0.5f, float(3.25 / 3.5), float(1.25 / 3.5), 0.1f});
}

TEST_CASE("a vertex of a backdrop has the evidence of the nearest pixel") {
  CompletedDepth depth = uniform(4, 2);
  depth.confirmations.values = {0, 1, 2, 3, 4, 5, 6, 7};
  depth.maps.consensus.values = {0, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f};
  const Intrinsics stored = pinholeFromFov(40, 20, 1);
  MorphMesh mesh;
  mesh.match = {{{0, 0}, {9.9f, 9.9f}, {10.1f, 0}, {40, 20}, {35, 5}, {-3, 25}}};
  mesh.ratio = {std::vector<float>(6, 1.0f)};
  mesh.inverseDistance.assign(6, 0.25f);
  addEvidence(mesh, stored, depth);
  CHECK(mesh.confirmations == std::vector<std::uint8_t>{0, 0, 1, 7, 3, 4});
  CHECK(mesh.consensus == std::vector<float>{0, 0, 0.1f, 0.7f, 0.3f, 0.4f});
  addEvidence(mesh, stored, depth);
  CHECK(mesh.confirmations.size() == 6);
  mesh.match.push_back(mesh.match[0]);
  CHECK(test::errorOf([&] { addEvidence(mesh, stored, depth); }).code() == ErrorCode::invalidInput);
}
