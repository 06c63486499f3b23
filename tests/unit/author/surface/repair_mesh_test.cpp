// SPDX-License-Identifier: Apache-2.0
#include "author/surface/repair_mesh.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::cube;

// Repairs the mesh and checks the invariants of every result.
RepairedMesh repaired(const TriangleMesh& mesh) {
  RepairedMesh result = repairMesh(mesh);
  CHECK(test::isOrientedManifold(result.mesh));
  CHECK(result.report.changed == (result.mesh != mesh));
  const RepairedMesh again = repairMesh(result.mesh);
  CHECK(again.mesh == result.mesh);
  CHECK_FALSE(again.report.changed);
  return result;
}

double volumeOf(const TriangleMesh& mesh) {
  double six = 0;
  for (const glm::uvec3& t : mesh.triangles)
    six += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z]));
  return six / 6;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + first);
}

TEST_CASE("a mesh without faults is unchanged") {
  for (const TriangleMesh& mesh : {cube(), test::flatGrid(4), test::sphere(12), TriangleMesh{}}) {
    const RepairedMesh result = repaired(mesh);
    CHECK(result.mesh == mesh);
  }
  // The faces of a cavity point into the cavity.
  TriangleMesh hollow = cube(glm::dvec3(-1.0), 3.0);
  TriangleMesh inner = cube();
  for (glm::uvec3& t : inner.triangles) std::swap(t.y, t.z);
  append(hollow, inner);
  CHECK(repaired(hollow).mesh == hollow);
}

TEST_CASE("separate triangles become a closed surface with outward normals") {
  const TriangleMesh whole = cube();
  TriangleMesh soup;
  for (const glm::uvec3& t : whole.triangles) {
    const auto first = std::uint32_t(soup.positions.size());
    for (int k = 0; k < 3; ++k) soup.positions.push_back(whole.positions[t[k]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  std::mt19937 random(3);
  for (int trial = 0; trial < 8; ++trial) {
    TriangleMesh turned = soup;
    for (glm::uvec3& t : turned.triangles)
      if (random() % 2) std::swap(t.y, t.z);
    const RepairedMesh result = repaired(turned);
    CHECK(result.mesh.positions.size() == 8);
    CHECK(result.report.stitchedEdges == 18);
    CHECK(test::borderEdges(result.mesh) == 0);
    CHECK(volumeOf(result.mesh) == Approx(1.0));
  }
}

TEST_CASE("unusable faces are left out and counted", "[N15]") {
  TriangleMesh mesh = cube();
  mesh.positions.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  mesh.positions.emplace_back(0, 0, 0);
  mesh.triangles.emplace_back(0, 1, 8);   // not finite
  mesh.triangles.emplace_back(0, 1, 77);  // vertex index out of range
  mesh.triangles.emplace_back(1, 1, 2);   // collapses to an edge
  mesh.triangles.emplace_back(0, 9, 1);   // two corners at one position
  mesh.triangles.emplace_back(1, 0, 2);   // a duplicate
  const RepairedMesh result = repaired(mesh);
  CHECK(result.mesh == cube());
  CHECK(result.report.unusableFaces == 4);
  CHECK(result.report.duplicateFaces == 1);
  CHECK(result.report.verticesBefore == 10);
  CHECK(result.report.verticesAfter == 8);

  TriangleMesh none;
  none.positions = {glm::dvec3(0.0)};
  none.triangles = {{0, 0, 0}};
  CHECK(repaired(none).mesh == TriangleMesh{});
}

TEST_CASE("non-manifold edges and vertices are cut, and each sheet stays connected", "[N15]") {
  SECTION("a fin on a box") {
    TriangleMesh mesh = cube();
    mesh.positions.emplace_back(0.5, -1.0, -1.0);
    mesh.triangles.emplace_back(0, 1, 8);
    const RepairedMesh result = repaired(mesh);
    CHECK(result.report.cutEdges == 1);
    CHECK(result.mesh.triangles.size() == 13);
    CHECK(result.mesh.positions.size() == 11);
    CHECK(test::borderEdges(result.mesh) == 3);
  }
  SECTION("two boxes at an edge") {
    TriangleMesh mesh = cube();
    append(mesh, cube({1, 1, 0}));
    for (glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        if (t[k] == 8) t[k] = 3;
        if (t[k] == 12) t[k] = 7;
      }
    const RepairedMesh result = repaired(mesh);
    CHECK(result.report.cutEdges == 1);
    CHECK(result.mesh.positions.size() == 16);
    CHECK(test::borderEdges(result.mesh) == 0);
  }
  SECTION("two boxes at a corner") {
    TriangleMesh mesh = cube();
    append(mesh, cube(glm::dvec3(1.0)));
    for (glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        if (t[k] == 8) t[k] = 7;
    CHECK(repaired(mesh).mesh.positions.size() == 16);
  }
}

TEST_CASE("a one-sided surface is cut") {
  TriangleMesh mesh;
  constexpr std::uint32_t kSteps = 12;
  for (std::uint32_t k = 0; k < kSteps; ++k) {
    const double around = 2 * std::numbers::pi * k / kSteps;
    const glm::dvec3 out(std::cos(around), std::sin(around), 0);
    const glm::dvec3 across = std::cos(around / 2) * out + glm::dvec3(0, 0, std::sin(around / 2));
    mesh.positions.push_back(2.0 * out + 0.5 * across);
    mesh.positions.push_back(2.0 * out - 0.5 * across);
  }
  for (std::uint32_t k = 0; k < kSteps; ++k) {
    std::uint32_t a = 2 * k, b = a + 1, c = (a + 2) % (2 * kSteps), d = c + 1;
    if (k + 1 == kSteps) std::swap(c, d);
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(c, b, d);
  }
  const RepairedMesh result = repaired(mesh);
  CHECK(result.mesh.triangles.size() == mesh.triangles.size());
  CHECK(result.report.cutEdges == 1);
  CHECK(test::eulerNumber(result.mesh) == 1);
}

TEST_CASE("faces without area are removed without leaving a hole") {
  // The midpoint of an edge is a corner of two faces on one side, and of a flat face on the other side.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, -1, 0}};
  mesh.triangles = {{0, 2, 3}, {2, 1, 3}, {0, 1, 2}, {1, 0, 4}};
  const RepairedMesh result = repaired(mesh);
  CHECK(result.report.degenerateFaces == 1);
  CHECK(result.report.degenerateFacesLeft == 0);
  CHECK(result.mesh.triangles.size() == 4);
  CHECK(test::borderEdges(result.mesh) == 4);
  CHECK(test::areaOf(result.mesh) == Approx(2.0));
}

TEST_CASE("random triangles become a manifold", "[N15]") {
  std::mt19937 random(11);
  for (int trial = 0; trial < 40; ++trial) {
    TriangleMesh mesh;
    for (int v = 0; v < 12; ++v) mesh.positions.emplace_back(random() % 4, random() % 4, random() % 4);
    for (int f = 0; f < 40; ++f) mesh.triangles.emplace_back(random() % 13, random() % 12, random() % 12);
    CAPTURE(trial);
    repaired(mesh);
  }
}

}  // namespace
}  // namespace ibr
