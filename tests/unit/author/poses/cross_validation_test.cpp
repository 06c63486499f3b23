// SPDX-License-Identifier: Apache-2.0
#include "author/poses/cross_validation.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "ibr/author/poses.h"
#include "support/pose_noise.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

std::vector<Camera> row() {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(lookingAlong({0.3 * i, 0, 0.1 * (i % 2)}, {0, 1, 0}, 400, 300));
  return cameras;
}

std::vector<BundleCamera> bundled(const std::vector<Camera>& cameras) {
  std::vector<BundleCamera> list;
  for (const Camera& camera : cameras) list.push_back({camera});
  return list;
}

// Points on a wall that all cameras see, and as many distant points.
std::vector<BundlePoint> seenBy(const std::vector<Camera>& cameras, double noisePx) {
  PoseNoise random(2);
  std::vector<BundlePoint> points;
  for (int i = 0; i < 800; ++i) {
    BundlePoint point{{glm::dvec3(0.6, 6, 0) + random.vector(2), i % 2 ? 1.0 : 0.01}, {}};
    for (std::uint32_t c = 0; c < cameras.size(); ++c)
      if (const auto pixel = seenAt(cameras[c], point.position))
        point.seen.push_back({c, *pixel + glm::dvec2(random.vector(noisePx))});
    points.push_back(point);
  }
  return points;
}

}  // namespace

TEST_CASE("a patch covers one direction and a twelfth of a photograph's width; half of the patches are odd") {
  const std::vector<Camera> cameras = row();
  const std::vector<BundlePoint> points = seenBy(cameras, 0);
  const std::vector<std::uint32_t> patches = patchesOf(cameras, points);
  REQUIRE(patches.size() == points.size());
  std::map<std::uint32_t, std::vector<glm::dvec3>> all;
  for (std::size_t p = 0; p < points.size(); ++p)
    all[patches[p]].push_back(
        glm::normalize(glm::dvec3(points[p].position) - points[p].position.w * glm::dvec3(0.6, 0, 0.04)));
  CHECK(all.size() > 40);
  const double width = 400 / cameras[0].intrinsics.fx / 12;
  std::size_t odd = 0;
  for (const auto& [number, ways] : all) {
    odd += number % 2;
    for (const glm::dvec3& way : ways) CHECK(glm::distance(way, ways[0]) < width * std::sqrt(3.0));
  }
  CHECK(std::abs(double(odd) / double(all.size()) - 0.5) < 0.2);
  // Orientation, position and scale of the world have no effect, apart from rounding at the limits.
  const SimilarityTransform move{300, glm::angleAxis(2.0, glm::normalize(glm::dvec3(1, 2, -1))), {40, -7, 9}};
  std::vector<Camera> moved = cameras;
  std::vector<BundlePoint> there = points;
  for (Camera& camera : moved) camera.pose = move(camera.pose);
  for (BundlePoint& point : there)
    point.position = glm::dvec4(move(glm::dvec3(point.position) / point.position.w), 1) * point.position.w;
  const std::vector<std::uint32_t> same = patchesOf(moved, there);
  std::size_t differ = 0;
  for (std::size_t p = 0; p < points.size(); ++p) differ += same[p] != patches[p];
  CHECK(differ < 4);
  CHECK(patchesOf(cameras, std::vector<BundlePoint>{}).empty());
}

TEST_CASE("the cost of points grows with the pose error, is zero for exact poses and bounded for outliers") {
  const std::vector<Camera> exact = row();
  std::vector<BundlePoint> points = seenBy(exact, 0);
  for (const double cost : costsOf(bundled(exact), points, 0.2)) CHECK(cost == 0);
  const auto sum = [&](double radians) {
    double all = 0;
    for (const double cost : costsOf(bundled(PoseNoise(4).on(exact, radians, 0)), points, 0.2)) all += cost;
    return all;
  };
  CHECK(sum(0.0005) > 1);
  CHECK(sum(0.002) > 2 * sum(0.0005));
  points[7].seen.resize(1);
  points[8].seen[0].pixel.x += 300;
  const std::vector<double> costs = costsOf(bundled(exact), points, 0.2);
  CHECK(costs[7] == 0);
  CHECK(costs[8] > 5);
  CHECK(costs[8] < 20);
}

TEST_CASE("a gain is significant if many patches share it, not if a single patch has it") {
  PoseNoise random(6);
  std::vector<double> before, noise, gain, place;
  std::vector<std::uint32_t> patches;
  for (std::uint32_t p = 0; p < 3000; ++p) {
    patches.push_back(p / 20);
    before.push_back(1 + random.uniform(-0.5, 0.5));
    noise.push_back(1 + random.uniform(-0.5, 0.5));
    gain.push_back(noise.back() - 0.1);
    place.push_back(before.back() - (p < 20 ? 0.9 : 0));
  }
  CHECK(std::abs(significance(before, noise, patches)) < 3);
  CHECK(significance(before, gain, patches) > 5);
  CHECK(significance(gain, before, patches) < -5);
  CHECK(std::abs(significance(before, place, patches)) < 1.1);
  // Repeated points add no information.
  const auto thrice = [](auto values) {
    const auto one = values;
    for (int i = 0; i < 2; ++i) values.insert(values.end(), one.begin(), one.end());
    return values;
  };
  CHECK(significance(thrice(before), thrice(gain), thrice(patches)) ==
        Approx(significance(before, gain, patches)).epsilon(1e-9));
  // Too few samples, and samples without information.
  const std::span<const double> few(before.data(), 100), fewer(gain.data(), 100);
  CHECK(std::isnan(significance(few, fewer, patches)));
  const std::vector<double> none(3000, 0.0);
  CHECK(std::isnan(significance(none, none, patches)));
  CHECK(significance(before, before, patches) == 0);
}
