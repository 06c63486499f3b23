// SPDX-License-Identifier: Apache-2.0
#include "author/depth/depth_consistency.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "author/backdrop/complete_depth.h"
#include "lab/generate/synthetic.h"

using namespace ibr;

namespace {

constexpr int kWidth = 80, kHeight = 60;

// Four photographs of a wall with exact depth, 0.5 units apart.
std::vector<ConsistentDepth> wall() {
  SyntheticOptions options;
  for (const double x : {0.0, 0.5, 1.0, 1.5})
    options.cameras.push_back({pinholeFromFov(kWidth, kHeight, 0.9), {{x, 0, 0}, {1, 0, 0, 0}}});
  options.planes = {{.origin = {0, 0, -4}, .extentU = 40, .extentV = 40, .wavelength = 1}};
  const SyntheticScene scene = makeScene(options);
  std::vector<ConsistentDepth> depths;
  for (const Camera& camera : options.cameras) {
    ImageF inverse = renderDepth(scene, camera);
    for (float& value : inverse.values) value = 1 / value;
    depths.push_back({{camera, std::move(inverse)}, 2 / (camera.intrinsics.fx * 0.5), 0});
  }
  return depths;
}

int count(const Image8& counts, int x, int y) {
  return counts.pixel(x, y)[0];
}

}  // namespace

TEST_CASE("exact depth is confirmed by all photographs that see it, and contradicted by none") {
  const auto depths = wall();
  const auto evidence = depthEvidence(depths);
  CHECK(count(evidence[1].confirmations, 40, 30) == 3);
  CHECK(count(evidence[1].usableSources, 40, 30) == 3);
  CHECK(std::ranges::all_of(evidence[1].contradictions.values, [](int v) { return v == 0; }));
}

TEST_CASE("a false surface in front is contradicted, a false surface behind is only unconfirmed") {
  auto depths = wall();
  const auto planted = [&](float inverseDepth) {
    for (int y = 25; y < 35; ++y)
      for (int x = 35; x < 45; ++x) depths[1].map.inverseDepth.pixel(x, y)[0] = inverseDepth;
    return depthEvidence(depths);
  };
  const auto front = planted(0.5f);
  CHECK(count(front[1].confirmations, 40, 30) == 0);
  CHECK(count(front[1].contradictions, 40, 30) >= 2);
  CHECK(count(front[1].usableSources, 40, 30) == 3);
  const auto behind = planted(0.1f);
  CHECK(count(behind[1].confirmations, 40, 30) == 0);
  CHECK(count(behind[1].contradictions, 40, 30) == 0);
  // No two photographs have parallax at this distance. Only confirmed depth of another surface contradicts the pixel.
  const auto far = planted(0.001f);
  CHECK(count(far[1].confirmations, 40, 30) == 0);
  CHECK(count(far[1].contradictions, 40, 30) == 0);
  CHECK(count(far[1].usableSources, 40, 30) == 3);
  for (ConsistentDepth& depth : depths) std::ranges::fill(depth.map.inverseDepth.values, 0.001f);
  for (const DepthEvidence& distant : depthEvidence(depths))
    CHECK(std::ranges::all_of(distant.usableSources.values, [](int w) { return w == 0; }));
}

TEST_CASE("unknown depth gives no evidence, and photographs of one position do not confirm each other") {
  auto depths = wall();
  std::ranges::fill(depths[0].map.inverseDepth.values, kUnknownDepth);
  const auto evidence = depthEvidence(depths);
  CHECK(std::ranges::all_of(evidence[0].confirmations.values, [](int c) { return c == 0; }));
  CHECK(count(evidence[1].confirmations, 40, 30) == 2);
  std::vector<ConsistentDepth> together(depths.begin() + 1, depths.end());
  for (ConsistentDepth& depth : together) depth.map.camera.pose.position = {0, 0, 0};
  for (const DepthEvidence& one : depthEvidence(together))
    CHECK(std::ranges::all_of(one.confirmations.values, [](int c) { return c == 0; }));
  for (const DepthEvidence& one : depthEvidence(together))
    CHECK(std::ranges::all_of(one.usableSources.values, [](int w) { return w == 0; }));
}

TEST_CASE("evidence does not depend on the thread count, and grows with the number of sources") {
  const auto depths = wall();
  const auto one = depthEvidence(depths, 10, 1), three = depthEvidence(depths, 10, 3),
             few = depthEvidence(depths, 1, 1);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    CHECK(one[i].confirmations == three[i].confirmations);
    CHECK(one[i].contradictions == three[i].contradictions);
    CHECK(std::ranges::max(few[i].confirmations.values) <= 1);
  }
  CHECK(depthEvidence({}).empty());
}

TEST_CASE("a residual widens the tolerance") {
  auto depths = wall();
  for (float& value : depths[1].map.inverseDepth.values) value *= 1.45f;
  CHECK(count(depthEvidence(depths)[1].confirmations, 40, 30) == 0);
  for (ConsistentDepth& depth : depths) depth.residualPx = 4;
  CHECK(count(depthEvidence(depths)[1].confirmations, 40, 30) == 3);
}
