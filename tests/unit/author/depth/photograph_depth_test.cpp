// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_depth.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "lab/generate/synthetic.h"
#include "support/error_of.h"
#include "support/exact_depth.h"

using namespace ibr;

namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kDistance = 4;
constexpr std::uint32_t kPanorama = 3;
const std::set<std::uint32_t> kMatched{0, 1, 2, 4};  // nodes of wall() with a matched depth

// Photographs of a wall, 0.5 units apart, and a panorama among them.
SyntheticScene wall() {
  SyntheticOptions options;
  const auto add = [&](double x) {
    options.cameras.push_back({pinholeFromFov(kWidth, kHeight, 0.9), {{x, 0, 0}, {1, 0, 0, 0}}});
  };
  for (const double x : {0.0, 0.5, 1.0}) add(x);
  options.cameras.push_back({{CameraModel::equirectangular, 64, 32}, {{1.2, 0, 0}, {1, 0, 0, 0}}});
  for (const double x : {1.5, 2.0}) add(x);
  options.planes = {{.origin = {0, 0, -kDistance}, .extentU = 40, .extentV = 40, .wavelength = 1}};
  options.cells = {{0, 1}};  // not used
  options.gridStep = kWidth;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

std::vector<PhotographDepth> depthsOf(const SyntheticScene& made, const PhotographDepthOptions& options) {
  return depthOfPhotographs(test::camerasOf(made.scene), options);
}

bool isUnknown(const ImageF& map) {
  return std::ranges::all_of(map.values, [](float w) { return w == kUnknownDepth; });
}

float valueAt(const ImageF& map, int x, int y) {
  return map.pixel(x, y)[0];
}

CompletedDepth uniform(int width, int height) {
  const ImageF depth(width, height, 1, 0.25f);
  return {{depth, ImageF(width, height, 1, 0.5f)}, depth, Image8(width, height, 1, 2)};
}

}  // namespace

TEST_CASE("each photograph has its matched depth, and is confirmed by the others") {
  const SyntheticScene made = wall();
  const std::vector<PhotographDepth> depths =
      depthsOf(made, {.matches = test::exactMatches(made, kMatched), .residualPx = 1});
  REQUIRE(depths.size() == 6);
  for (std::uint32_t n = 0; n < 6; ++n) {
    if (n == kPanorama) continue;
    CHECK(depths[n].node == n);
    CHECK(depths[n].matched.map.camera.intrinsics.width == kWidth);
    // The step is 2 px of parallax at the median spacing, 0.5 units.
    CHECK(depths[n].matched.step == Approx(2 / (made.scene.nodes[0].camera.intrinsics.fx * 0.5)));
    CHECK(depths[n].matched.residualPx == Approx(1));
  }
  for (const std::uint32_t n : {0, 1, 2, 4})
    CHECK(valueAt(depths[n].matched.map.inverseDepth, kWidth / 2, kHeight / 2) == Approx(1 / kDistance).epsilon(1e-3));
  CHECK(int(depths[1].evidence.confirmations.pixel(kWidth / 2, kHeight / 2)[0]) == 3);
  for (const std::uint32_t n : {kPanorama, 5u}) CHECK(isUnknown(depths[n].matched.map.inverseDepth));
}

TEST_CASE("a panorama has the distances of its faces, and panoramas confirm each other") {
  SyntheticOptions options;
  for (const double x : {0.0, 0.5, 1.0})
    options.cameras.push_back({{CameraModel::equirectangular, 128, 64}, {{x, 0, 0}, {1, 0, 0, 0}}});
  options.planes = {{.origin = {0, 0, -kDistance}, .extentU = 40, .extentV = 40, .wavelength = 1}};
  options.cells = {{0, 1}};  // not used
  options.samplesPerAxis = 1;
  const SyntheticScene made = makeScene(options);
  const std::vector<PhotographDepth> depths = depthsOf(made, {.matches = test::exactMatches(made, {0, 1, 2})});
  REQUIRE(depths.size() == 3);
  for (std::uint32_t n = 0; n < 3; ++n) {
    CAPTURE(n);
    CHECK(depths[n].node == n);
    CHECK(depths[n].matched.step == Approx(2 / (128 / (2 * std::numbers::pi) * 0.5)));
    const Intrinsics& k = depths[n].matched.map.camera.intrinsics;
    REQUIRE(k.model == CameraModel::equirectangular);
    for (const glm::ivec2 at : {glm::ivec2(64, 32), {74, 32}, {54, 25}, {66, 40}}) {
      const glm::dvec3 ray = unproject(k, glm::dvec2(at) + 0.5);
      CHECK(valueAt(depths[n].matched.map.inverseDepth, at.x, at.y) == Approx(-ray.z / kDistance).epsilon(0.05));
      CHECK(int(depths[n].evidence.confirmations.pixel(at.x, at.y)[0]) == 2);
    }
    CHECK(valueAt(depths[n].matched.map.inverseDepth, 0, 32) == kUnknownDepth);  // no surface behind the panorama
  }
}

TEST_CASE("an unmatched photograph takes the depth of its points") {
  const SyntheticScene made = wall();
  std::vector<std::uint32_t> asked;
  const PhotographPoints points = [&](std::uint32_t node) {
    asked.push_back(node);
    return std::vector<glm::dvec3>{{2, 0, -5}};
  };
  const std::vector<PhotographDepth> depths =
      depthsOf(made, {.matches = test::exactMatches(made, kMatched), .points = points});
  // Matches of the panorama are requested once for each of its faces.
  CHECK(asked == std::vector<std::uint32_t>{kPanorama, kPanorama, kPanorama, kPanorama, kPanorama, kPanorama, 5});
  CHECK(depths[kPanorama].sparse);
  CHECK(depths[5].sparse);
  CHECK(std::ranges::count_if(depths[5].matched.map.inverseDepth.values, [](float w) { return w >= 0; }) == 1);
  CHECK(valueAt(depths[5].matched.map.inverseDepth, kWidth / 2, kHeight / 2) == Approx(0.2));
  const CompletedDepth whole = completed(depths[5], Image8(kWidth, kHeight, 3, 90));
  for (const float rho : whole.maps.inverseDepth.values) CHECK(rho == Approx(0.2));
}

TEST_CASE("an unmatched panorama takes the depth of its points") {
  const SyntheticScene made = wall();
  std::vector<glm::dvec3> points;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) points.push_back({1.2 + 0.3 * x, 0.3 * y, -5});
  const std::vector<PhotographDepth> depths =
      depthsOf(made, {.matches = test::exactMatches(made, kMatched), .points = [&](std::uint32_t) { return points; }});
  const ImageF& map = depths[kPanorama].matched.map.inverseDepth;
  std::size_t known = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      if (const float w = valueAt(map, x, y); w >= 0) {
        ++known;
        const glm::dvec3 ray = unproject(depths[kPanorama].matched.map.camera.intrinsics, {x + 0.5, y + 0.5});
        CHECK(w == Approx(-ray.z / 5).epsilon(0.1));
      }
  CHECK(known > 20);
}

TEST_CASE("a panorama is completed across its seam") {
  // Two columns at the left end and two at the right are unknown. They are completed across the seam.
  constexpr int kSide = 64;
  PhotographDepth depth;
  depth.matched = {{{{CameraModel::equirectangular, kSide, kSide / 2}, {}}, ImageF(kSide, kSide / 2, 1)}, 0.01, 0};
  depth.evidence = {Image8(kSide, kSide / 2, 1, 4), Image8(kSide, kSide / 2, 1, 0), Image8(kSide, kSide / 2, 1, 4)};
  for (int y = 0; y < kSide / 2; ++y)
    for (int x = 0; x < kSide; ++x)
      depth.matched.map.inverseDepth.pixel(x, y)[0] = x < 2 || x >= kSide - 2 ? kUnknownDepth
                                                      : x < kSide / 2         ? 0.5f
                                                                              : 1;
  const CompletedDepth whole = completed(depth, Image8(kSide, kSide / 2, 3, 90));
  const auto at = [&](int x) { return valueAt(whole.maps.inverseDepth, x, kSide / 4); };
  CHECK(at(2) == 0.5f);
  CHECK(at(kSide - 3) == 1);
  CHECK(at(1) == Approx(0.6).margin(0.02));
  CHECK(at(0) == Approx(0.7).margin(0.02));
  CHECK(at(kSide - 1) == Approx(0.8).margin(0.02));
  CHECK(at(kSide - 2) == Approx(0.9).margin(0.02));
}

TEST_CASE("depth does not depend on the order of its jobs, and a job runner can cancel it") {
  const SyntheticScene made = wall();
  const JobRunner backwards = [](std::size_t count, const std::function<void(std::size_t)>& job) {
    for (std::size_t i = count; i-- > 0;) job(i);
  };
  const DepthMatches matches = test::exactMatches(made, kMatched);
  const auto one = depthsOf(made, {.matches = matches}),
             two = depthsOf(made, {.matches = matches, .depths = backwards, .evidence = backwards});
  REQUIRE(one.size() == 6);
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(one[i].matched.map.inverseDepth == two[i].matched.map.inverseDepth);
    CHECK(one[i].evidence.confirmations == two[i].evidence.confirmations);
    CHECK(one[i].evidence.contradictions == two[i].evidence.contradictions);
  }
  const JobRunner stops = [](std::size_t, const auto&) { throw Error(ErrorCode::cancelled, "stopped"); };
  for (const PhotographDepthOptions& options : {PhotographDepthOptions{.matches = matches, .depths = stops},
                                                PhotographDepthOptions{.matches = matches, .evidence = stops}})
    CHECK(test::errorOf([&] { depthsOf(made, options); }).code() == ErrorCode::cancelled);
}

TEST_CASE("without photographs there is no depth") {
  CHECK(depthOfPhotographs({}, {}).empty());
}

TEST_CASE("completed depth keeps confirmed and unverifiable depth, and has no confirmations elsewhere") {
  struct Case {
    int confirmations, contradictions, usableSources;
    bool sky, kept;
    float consensus;
  };
  const float completion = kCompletedConsensus;
  for (const Case& each : {Case{0, 0, 0, false, true, 0.5f},
                           {3, 0, 3, false, true, float(3.25 / 3.5)},
                           {2, 5, 9, false, true, float(2.25 / 7.5)},
                           {1, 0, 4, false, true, float(1.25 / 1.5)},
                           {1, 1, 4, false, false, completion},
                           {0, 0, 1, false, false, completion},
                           {0, 3, 6, true, true, float(2.25 / 2.5)}}) {
    CAPTURE(each.confirmations, each.contradictions, each.usableSources, each.sky);
    // Every second column has the case's evidence; the columns between are confirmed.
    constexpr int kSide = 12;
    PhotographDepth depth;
    depth.matched = {{{pinholeFromFov(kSide, kSide, 1), {}}, ImageF(kSide, kSide, 1, 0.5f)}, 0.01, 0};
    depth.evidence = {Image8(kSide, kSide, 1, 4), Image8(kSide, kSide, 1, 0), Image8(kSide, kSide, 1, 4)};
    depth.sky = Image8(kSide, kSide, 1, 0);
    for (int y = 0; y < kSide; ++y)
      for (int x = 1; x < kSide; x += 2) {
        depth.evidence.confirmations.pixel(x, y)[0] = std::uint8_t(each.confirmations);
        depth.evidence.contradictions.pixel(x, y)[0] = std::uint8_t(each.contradictions);
        depth.evidence.usableSources.pixel(x, y)[0] = std::uint8_t(each.usableSources);
        depth.sky.pixel(x, y)[0] = each.sky ? 255 : 0;
      }
    std::ranges::fill(std::span(depth.evidence.confirmations.values).first(kSide), std::uint8_t(4));  // row 0 joins all
    const CompletedDepth whole = completed(depth, Image8(kSide, kSide, 3, 90));
    for (const float rho : whole.maps.inverseDepth.values) CHECK(rho == Approx(0.5));
    CHECK((valueAt(whole.kept, 5, 6) >= 0) == each.kept);
    CHECK(valueAt(whole.maps.consensus, 5, 6) == each.consensus);
    CHECK(int(whole.confirmations.pixel(5, 6)[0]) == (!each.kept ? 0 : each.sky ? 2 : each.confirmations));
    CHECK(int(whole.confirmations.pixel(4, 6)[0]) == 4);
  }
}

TEST_CASE("confirmed surfaces that are too small are completed from their surroundings") {
  for (const auto& [side, finer] : {std::pair(5, 1), std::pair(6, 1), std::pair(10, 2), std::pair(11, 2)}) {
    CAPTURE(side, finer);
    PhotographDepth depth;
    depth.finer = finer;
    depth.matched = {{{pinholeFromFov(40, 30, 1), {}}, ImageF(40, 30, 1, 0.5f)}, 0.01, 0};
    depth.evidence = {Image8(40, 30, 1, 4), Image8(40, 30, 1, 0), Image8(40, 30, 1, 4)};
    for (int y = 10; y < 10 + side; ++y)
      for (int x = 10; x < 10 + side; ++x) depth.matched.map.inverseDepth.pixel(x, y)[0] = 2;
    const CompletedDepth whole = completed(depth, Image8(40, 30, 3, 90));
    const bool large = side * side >= kMinSurfacePx * finer * finer;
    CHECK(valueAt(whole.maps.inverseDepth, 12, 12) == Approx(large ? 2 : 0.5));
    CHECK(int(whole.confirmations.pixel(12, 12)[0]) == (large ? 4 : 0));
  }
}

TEST_CASE("matched depth takes precedence over points, and brings its size and sky") {
  const SyntheticScene made = wall();
  SweptDepth matched{ImageF(48, 36, 1, 0.125f), Image8(48, 36, 1, 0)};
  matched.sky.values[7] = 255;
  const DepthMatches matches = [&](std::size_t view) -> std::optional<SweptDepth> {
    if (view == 2) return SweptDepth{ImageF(2 * kWidth, 2 * kHeight, 1, 0.125f), Image8(2 * kWidth, 2 * kHeight, 1)};
    return view == 1 ? std::optional(matched) : std::nullopt;
  };
  const PhotographPoints points = [](std::uint32_t node) {
    return std::vector<glm::dvec3>{{0.5 * node, 0, -kDistance}};
  };
  const std::vector<PhotographDepth> depths = depthsOf(made, {.matches = matches, .points = points});
  CHECK(depths[2].finer == 2);
  CHECK(depths[1].matched.map.inverseDepth == matched.inverseDepth);
  CHECK(depths[1].sky == matched.sky);
  CHECK(depths[1].matched.map.camera.intrinsics.width == 48);
  CHECK(depths[1].matched.map.camera.intrinsics.fx == Approx(made.scene.nodes[1].camera.intrinsics.fx / 2));
  CHECK(depths[1].finer == 1);
  CHECK((!depths[1].sparse && !depths[2].sparse));
  CHECK(depths[0].sparse);
  CHECK(depths[0].sky.empty());
  CHECK(valueAt(depths[0].matched.map.inverseDepth, kWidth / 2, kHeight / 2) == Approx(1 / kDistance).epsilon(1e-3));
}

TEST_CASE("a vertex has the evidence of the neighbouring surface whose depth it has") {
  CompletedDepth depth = uniform(8, 1);
  for (int x = 0; x < 8; ++x) {
    depth.maps.inverseDepth.pixel(x, 0)[0] = x < 4 ? 0.25f : 1.0f;
    depth.confirmations.pixel(x, 0)[0] = x < 4 ? 2 : 7;
  }
  const Intrinsics stored = pinholeFromFov(80, 10, 0.2);
  const glm::vec2 edge(41, 5);
  MorphMesh mesh;
  mesh.match = {{edge, edge}};
  mesh.ratio = {{1, 1}};
  for (const double w : {0.25, 1.0}) mesh.inverseDistance.push_back(float(w * -unproject(stored, edge).z));
  addEvidence(mesh, stored, depth);
  CHECK(mesh.confirmations == std::vector<std::uint8_t>{2, 7});
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
