// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/epipolar_direction.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

glm::dvec2 seenBy(const Camera& camera, glm::dvec3 point) {
  return *project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position));
}

}  // namespace

TEST_CASE("the epipolar direction is the motion of a match as its point comes nearer") {
  const double scale = GENERATE(1e-3, 1.0, 1e6);  // world units per metre
  const glm::dvec3 offset = GENERATE(glm::dvec3(0), glm::dvec3(4e5, -6e6, 300));
  const Camera camera = lookingAlong(offset + scale * glm::dvec3(1, 0.5, 0.2), {0.3, 1, -0.2});
  const glm::dvec3 centre = offset + scale * glm::dvec3(0, 0, 0.4), point = offset + scale * glm::dvec3(2, 7, 1);
  const glm::dvec2 there = seenBy(camera, point), nearer = seenBy(camera, glm::mix(point, centre, 0.01));
  const glm::dvec2 direction = epipolarDirection(camera, centre, there);
  CHECK(glm::length(direction) == Approx(1));
  CHECK(glm::dot(direction, glm::normalize(nearer - there)) > 0.99999);
}

TEST_CASE("the epipolar direction is defined for points at infinity") {
  const Camera camera = lookingAlong({1, 0, 0}, {0, 1, 0});
  const glm::dvec3 ray(0.1, 1, 0.2);
  const glm::dvec2 there = seenBy(camera, camera.pose.position + 1e9 * ray), far = seenBy(camera, 1e4 * ray);
  CHECK(glm::dot(epipolarDirection(camera, {0, 0, 0}, there), glm::normalize(far - there)) > 0.99999);
}

TEST_CASE("the epipolar direction is zero at the epipole and for coincident cameras") {
  const Camera camera = lookingAlong({1, 2, 3}, {0, 1, 0});
  CHECK(epipolarDirection(camera, {1, 2, 3}, {20, 30}) == glm::dvec2(0));
  CHECK(epipolarDirection(camera, {1, 0, 3}, {camera.intrinsics.cx, camera.intrinsics.cy}) == glm::dvec2(0));
  const glm::dvec2 beside(camera.intrinsics.cx + 1e-3, camera.intrinsics.cy);
  CHECK(glm::length(epipolarDirection(camera, {1, 0, 3}, beside) - glm::dvec2(1, 0)) < 1e-9);  // behind the camera
}
