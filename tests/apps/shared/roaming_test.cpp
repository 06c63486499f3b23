// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/roaming.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "shared/camera/up.h"

using namespace ibr;
using namespace ibr::app;

namespace {

std::vector<Pose> row(int count, double step, glm::dvec3 from = glm::dvec3(0)) {
  std::vector<Pose> cameras;
  for (int i = 0; i < count; ++i) cameras.push_back({from + glm::dvec3(i * step, 0, 0), glm::dquat(1, 0, 0, 0)});
  return cameras;
}

}  // namespace

TEST_CASE("bounds: positions inside are kept, positions outside move to the boundary without jumps") {
  for (const double far : {0.0, 1e6}) {
    const glm::dvec3 origin(far, far, far);
    RoamingBounds bounds{
        {origin, origin + glm::dvec3(1, 0, 0), origin + glm::dvec3(1, 1, 0), origin + glm::dvec3(5, 5, 5)},
        {{0, 1}, {1, 2}},
        0.3};
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    glm::dvec3 at = origin;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 step = 0.05 * glm::dvec3(any(random), any(random), any(random));
      const glm::dvec3 to = at + step, kept = clampedToBounds(bounds, at, to);
      const double rounding = 1e-15 * std::max(1.0, far) + 1e-12;
      REQUIRE(distanceTo(bounds, kept) <= 0.3 + 4 * rounding);
      REQUIRE(glm::distance(kept, to) <= glm::length(step) + 4 * rounding);  // no further than the requested step
      if (distanceTo(bounds, to) <= 0.3) REQUIRE(kept == to);
      at = kept;
    }
    const glm::dvec3 below = clampedToBounds(bounds, origin, origin + glm::dvec3(0.4, -7, 0));
    CHECK(glm::distance(below, origin + glm::dvec3(0.4, -0.3, 0)) < 1e-9);

    // From outside, motion inwards is free, motion outwards is stopped, and nothing jumps.
    const glm::dvec3 outside = origin + glm::dvec3(0, -2, 0);
    CHECK(clampedToBounds(bounds, outside, outside + glm::dvec3(0, 0.1, 0)) == outside + glm::dvec3(0, 0.1, 0));
    CHECK(glm::distance(clampedToBounds(bounds, outside, outside - glm::dvec3(0, 0.1, 0)), outside) < 1e-9);
  }
  CHECK(clampedToBounds({}, {1, 2, 3}, {4, 5, 6}) == glm::dvec3(4, 5, 6));
  CHECK(std::isinf(distanceTo({}, {1, 2, 3})));
}

TEST_CASE("neighbours: each pair of a cell occurs once, and cameras at one position are no neighbours") {
  Scene scene;
  scene.nodes.resize(4);
  scene.cells.resize(2);
  scene.cells[0].members = {2, 0, 1};
  scene.cells[1].members = {1, 2};
  CHECK(cellNeighbours(scene) == std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {0, 2}, {1, 2}});
  auto cameras = row(4, 1);
  cameras.push_back(cameras[0]);
  CHECK(nearNeighbours(cameras, 1) ==
        std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 2}, {1, 4}, {2, 3}});
  for (const auto& [a, b] : nearNeighbours(cameras, 3))
    CHECK(glm::distance(cameras[a].position, cameras[b].position) > 0.5);
  CHECK(nearNeighbours({}, 3).empty());
  CHECK(nearNeighbours(row(1, 1), 3).empty());
}

TEST_CASE("the initial speed grows with the scene, and is valid without cameras") {
  CHECK(initialSpeed({}) == 1);
  CHECK(initialSpeed(row(1, 1)) == 1);
  CHECK(initialSpeed(row(5, 0)) == 1);
  CHECK(!neighbourDistance(row(5, 0)));
  for (const double far : {0.0, 1e6}) {
    CHECK(initialSpeed(row(5, 0.1, glm::dvec3(far))) == Approx(0.2).epsilon(1e-6));
    CHECK(initialSpeed(row(2000, 0.1, glm::dvec3(far))) == Approx(199.9 * 0.05).epsilon(1e-6));
    CHECK(*neighbourDistance(row(2000, 0.1, glm::dvec3(far))) == Approx(0.1).epsilon(1e-6));
  }
}

TEST_CASE("the nearest camera is found by position and direction, and the next and previous by index") {
  auto cameras = row(5, 1);
  cameras[3].rotation = glm::angleAxis(3.0, glm::dvec3(0, 1, 0));
  const glm::dquat ahead(1, 0, 0, 0);
  CHECK(*nearestCamera(cameras, {{2.1, 0, 0}, ahead}) == 2);
  CHECK(*nearestCamera(cameras, {{2.9, 0, 0}, ahead}) == 2);   // camera 3 is nearer, but looks backwards
  CHECK(*nearestCamera(cameras, {{2.9, 0, 0}, -ahead}) == 2);  // a quaternion and its negative are one rotation
  CHECK(*nearestCamera(cameras, {{2.1, 0, 0}, cameras[3].rotation}) == 3);
  CHECK(*nextCamera(cameras, cameras[2], 1) == 3);
  CHECK(*nextCamera(cameras, cameras[2], -1) == 1);
  CHECK(*nextCamera(cameras, cameras[4], 1) == 0);
  CHECK(*nextCamera(cameras, cameras[0], -1) == 4);
  CHECK(*nextCamera(cameras, cameras[0], -2) == 3);
  CHECK(*nextCamera(cameras, {{1.2, 0, 0}, ahead}, 1) == 1);
  CHECK(*nextCamera(cameras, {{1.2, 0, 0}, ahead}, -1) == 1);
  CHECK(*nextCamera(cameras, {{1.2, 0, 0}, ahead}, 2) == 2);
  CHECK(*nextCamera(cameras, {{1.2, 0, 0}, ahead}, 0) == 1);
  cameras[3] = cameras[2];  // two equal cameras: the next one is still reached
  CHECK(*nextCamera(cameras, cameras[3], 1) == 4);
  CHECK(*nextCamera(cameras, cameras[3], -1) == 1);
  CHECK(!nearestCamera({}, {}));
  CHECK(!nextCamera({}, {}, 1));
  CHECK(*nextCamera(row(1, 1), {}, 1) == 0);
  CHECK(*nextCamera(row(3, 0), {}, -2) < 3);
}

TEST_CASE("the up direction is the mean of the photographs' y axes") {
  CHECK(!upOf({}));
  const glm::dquat tilted = glm::angleAxis(0.4, glm::dvec3(1, 0, 0)), back = glm::angleAxis(-0.4, glm::dvec3(1, 0, 0));
  CHECK(glm::distance(*upOf({{{}, tilted}, {{1e6, 0, 0}, back}}), glm::dvec3(0, 1, 0)) < 1e-12);
  const glm::dquat over = glm::angleAxis(3.14159265358979, glm::dvec3(1, 0, 0));
  CHECK(!upOf({{{}, glm::dquat(1, 0, 0, 0)}, {{}, over}}));
}
