// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/mesh_pick.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

using namespace ibr;

namespace {

// Squares at z = −2, −5 and −7, the first one smaller, and one behind the eye; in random order.
TriangleMesh squares(glm::dvec3 at) {
  TriangleMesh mesh;
  const auto add = [&](double half, double z) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::dvec2 corner : {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1), glm::dvec2(-1, 1)})
      mesh.positions.push_back(at + glm::dvec3(half * corner, z));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 3, first + 2);  // opposite orientation
  };
  add(4, -5);
  add(1, -2);
  add(4, 3);
  add(4, -7);
  mesh.triangles.emplace_back(0, 0, 1);  // zero area
  return mesh;
}

}  // namespace

TEST_CASE("a picked point is the nearest intersection in front of the camera, at any origin") {
  for (const glm::dvec3 at : {glm::dvec3(0), glm::dvec3(3e6, -1e6, 2e6)}) {
    const TriangleMesh mesh = squares(at);
    const auto near = app::pickedPoint(mesh, at, {0.25, -0.125, -1});
    REQUIRE(near);
    CHECK(glm::distance(*near, at + glm::dvec3(0.5, -0.25, -2)) < 1e-8);
    const auto beside = app::pickedPoint(mesh, at, glm::dvec3(0.6, 0.1, -1) * 7.0);  // beside the small square
    REQUIRE(beside);
    CHECK(glm::distance(*beside, at + glm::dvec3(3, 0.5, -5)) < 1e-8);
    const auto behind = app::pickedPoint(mesh, at, {0, 0, 1});
    REQUIRE(behind);
    CHECK((*behind - at).z == Approx(3));
    CHECK(!app::pickedPoint(mesh, at, {1, 0, -1}));
    CHECK(!app::pickedPoint(mesh, at, {1, 0, 0}));  // parallel to all squares
  }
  CHECK(!app::pickedPoint(TriangleMesh{}, {0, 0, 0}, {0, 0, -1}));
}
