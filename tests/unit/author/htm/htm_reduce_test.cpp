// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_reduce.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::cube;

ReducedMesh reduced(const TriangleMesh& mesh, std::size_t faces) {
  HtmReduceOptions options;
  options.faceCount = faces;
  options.distanceSamples = 2000;
  ReducedMesh result = reduceMesh(mesh, options);
  CHECK(test::isOrientedManifold(result.mesh));
  CHECK(result.report.facesAfter == result.mesh.triangles.size());
  CHECK(result.report.reached == (result.mesh.triangles.size() <= faces));
  CHECK(result.report.meanFaceArea == Approx(test::areaOf(result.mesh) / double(result.mesh.triangles.size())));
  CHECK(test::eulerNumber(result.mesh) == test::eulerNumber(repairMesh(mesh).mesh));
  return result;
}

glm::dvec3 normalOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  return glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

TEST_CASE("a reduced sphere stays close to the sphere") {
  const ReducedMesh result = reduced(test::sphere(64), 300);
  CHECK(result.report.reached);
  CHECK(result.mesh.triangles.size() > 290);
  CHECK(result.report.collapses * 2 == result.report.facesBefore - result.report.facesAfter);
  for (const glm::uvec3& t : result.mesh.triangles) {
    const glm::dvec3 middle =
        (result.mesh.positions[t.x] + result.mesh.positions[t.y] + result.mesh.positions[t.z]) / 3.0;
    CHECK(glm::dot(normalOf(result.mesh, t), glm::normalize(middle)) > 0.9);
  }
  // A sphere of 300 faces has sides of about 0.31; the centres of faces lie 0.31²/6 below the sphere.
  CHECK(result.report.toReduced.max < 0.03);
  CHECK(result.report.toOriginal.max < 0.03);
  CHECK(result.report.toReduced.mean < 0.01);
  CHECK(result.report.toReduced.mean <= result.report.toReduced.p95);
  CHECK(result.report.toReduced.p95 <= result.report.toReduced.max);
}

TEST_CASE("a reduced flat grid stays flat, keeps its outline and flips no face", "[N15]") {
  const ReducedMesh result = reduced(test::flatGrid(12), 24);
  CHECK(result.report.reached);
  CHECK(test::areaOf(result.mesh) == Approx(144.0).epsilon(1e-9));
  for (const glm::uvec3& t : result.mesh.triangles) CHECK(normalOf(result.mesh, t).z == Approx(1.0));
  CHECK(result.report.toReduced.max < 1e-9);
}

TEST_CASE("sharp edges are kept while flat regions lose faces") {
  TriangleMesh mesh;
  // A finely divided cube: six grids with merged borders.
  const TriangleMesh grid = test::flatGrid(8);
  for (int side = 0; side < 6; ++side) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::dvec3& p : grid.positions) {
      glm::dvec3 q(p.x, p.y, side % 2 ? 8.0 : 0.0);
      for (int turn = 0; turn < side / 2; ++turn) q = {q.z, q.x, q.y};
      mesh.positions.push_back(q);
    }
    for (const glm::uvec3& t : grid.triangles)
      mesh.triangles.push_back((side % 2 ? t : glm::uvec3(t.x, t.z, t.y)) + first);
  }
  const ReducedMesh result = reduced(mesh, 30);
  CHECK(result.mesh.triangles.size() == 30);
  CHECK(test::areaOf(result.mesh) == Approx(6 * 64.0).epsilon(1e-4));
  CHECK(result.report.toReduced.max < 0.001);
}

TEST_CASE("reduction continues up to a mean face area") {
  HtmReduceOptions options;
  options.meanFaceArea = 0.05;
  const ReducedMesh result = reduceMesh(test::sphere(48), options);
  CHECK(result.report.reached);
  CHECK(result.report.meanFaceArea >= 0.05);
  CHECK(result.report.meanFaceArea < 0.051);
  options.meanFaceArea = 1e9;
  const ReducedMesh most = reduceMesh(test::sphere(48), options);
  CHECK_FALSE(most.report.reached);
  CHECK(test::eulerNumber(most.mesh) == 2);
  CHECK(test::isOrientedManifold(most.mesh));
}

TEST_CASE("reduction does not depend on the mesh's position", "[N15]") {
  TriangleMesh far = test::sphere(32);
  for (glm::dvec3& p : far.positions) p += glm::dvec3(4e6, -5e5, 1e6);
  const ReducedMesh near = reduced(test::sphere(32), 100), away = reduced(far, 100);
  CHECK(away.report.toReduced.max == Approx(near.report.toReduced.max).epsilon(0.3));
  CHECK(reduced(test::sphere(32), 100).mesh == near.mesh);
}

TEST_CASE("degenerate meshes are reduced or rejected", "[N15]") {
  SECTION("a triangle, a tetrahedron and a cube do not vanish") {
    const TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    CHECK(reduced(one, 1).mesh == one);
    const TriangleMesh four{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    CHECK(reduced(four, 1).mesh == four);
    CHECK(reduced(cube(), 1).mesh.triangles.size() >= 4);
  }
  SECTION("a mesh without usable faces is rejected") {
    CHECK(test::errorOf([] { reduced(TriangleMesh{}, 1); }).code() == ErrorCode::invalidInput);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const TriangleMesh none{{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    CHECK(test::errorOf([&] { reduced(none, 1); }).code() == ErrorCode::invalidInput);
  }
  SECTION("a grid with a needle is reduced") {
    TriangleMesh mesh = test::flatGrid(6);
    mesh.positions[24].x += 1 - 1e-7;
    reduced(mesh, 10);
  }
  SECTION("a torus keeps its hole") {
    TriangleMesh torus;
    constexpr std::uint32_t kN = 24;
    for (std::uint32_t i = 0; i < kN; ++i)
      for (std::uint32_t k = 0; k < kN; ++k) {
        const double a = 2 * std::numbers::pi * i / kN, b = 2 * std::numbers::pi * k / kN;
        torus.positions.emplace_back((3 + std::cos(b)) * std::cos(a), (3 + std::cos(b)) * std::sin(a), std::sin(b));
        const std::uint32_t p = i * kN + k, q = i * kN + (k + 1) % kN, r = (i + 1) % kN * kN + k,
                            s = (i + 1) % kN * kN + (k + 1) % kN;
        torus.triangles.emplace_back(p, r, s);
        torus.triangles.emplace_back(p, s, q);
      }
    CHECK(test::eulerNumber(reduced(torus, 1).mesh) == 0);
  }
  SECTION("random triangles are reduced") {
    std::mt19937 random(5);
    for (int trial = 0; trial < 20; ++trial) {
      TriangleMesh mesh;
      for (int v = 0; v < 30; ++v) mesh.positions.emplace_back(random() % 5, random() % 5, random() % 5);
      for (int f = 0; f < 90; ++f) mesh.triangles.emplace_back(random() % 30, random() % 30, random() % 30);
      reduced(mesh, 5);
    }
  }
}

TEST_CASE("invalid options are rejected, and reducing can be cancelled") {
  HtmReduceOptions options;
  options.meanFaceArea = std::numeric_limits<double>::quiet_NaN();
  CHECK(test::errorOf([&] { reduceMesh(cube(), options); }).code() == ErrorCode::invalidInput);
  options = {};
  options.maxTurnDegrees = 90;
  CHECK(test::errorOf([&] { reduceMesh(cube(), options); }).code() == ErrorCode::invalidInput);
  options = {};
  CHECK(reduceMesh(test::sphere(12), options).mesh == test::sphere(12));
  options.faceCount = 50;
  std::size_t calls = 0;
  options.progress = [&](const Progress& p) {
    CHECK(p.done <= p.total);
    return ++calls < 2;
  };
  CHECK(test::errorOf([&] { reduceMesh(test::sphere(64), options); }).code() == ErrorCode::cancelled);
}

TEST_CASE("the distance between parallel squares is exact") {
  TriangleMesh above = test::flatGrid(2);
  for (glm::dvec3& p : above.positions) p.z = 0.25;
  const SurfaceDistance distance = surfaceDistance(above, test::flatGrid(2), 500);
  CHECK(distance.mean == Approx(0.25));
  CHECK(distance.max == Approx(0.25));
  CHECK(distance.samples == 500);
  // Measured from the larger mesh, the outer part is far away.
  TriangleMesh small = test::flatGrid(1);
  CHECK(surfaceDistance(small, test::flatGrid(2), 500).max < 1e-12);
  CHECK(surfaceDistance(test::flatGrid(2), small, 500).max > 1.0);
}

}  // namespace
}  // namespace ibr
