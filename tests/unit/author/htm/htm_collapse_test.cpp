// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_collapse.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

glm::dvec3 middleOf(const TriangleMesh& mesh, std::uint32_t f) {
  const glm::uvec3& t = mesh.triangles[f];
  return (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
}

// Difference of each face: a function of the face's centre.
template <class F>
FaceDifferences byMiddle(F value) {
  return [value](const TriangleMesh& mesh, std::span<const std::uint32_t> faces) {
    std::vector<double> result;
    for (const std::uint32_t f : faces) {
      CHECK(mesh.triangles[f].x != mesh.triangles[f].y);  // only existing faces are evaluated
      result.push_back(value(middleOf(mesh, f)));
    }
    return result;
  };
}

CollapsedMesh collapsed(const TriangleMesh& mesh, const FaceDifferences& differences,
                        const HtmCollapseOptions& options) {
  CollapsedMesh result = collapseDifferences(mesh, differences, options);
  CHECK(test::isOrientedManifold(result.mesh));
  CHECK(result.report.facesAfter == result.mesh.triangles.size());
  CHECK(result.differences.size() == result.mesh.triangles.size());
  CHECK(result.report.collapses <= options.maxCollapses);
  return result;
}

TEST_CASE("faces with large differences grow, all others are unchanged") {
  const TriangleMesh grid = test::flatGrid(16);
  HtmCollapseOptions options;
  options.faceArea = 3.0;
  options.floor = 0.5;
  const auto value = [](glm::dvec3 p) { return p.x < 6 ? 1.0 + 0.01 * p.y : 0.1; };
  const CollapsedMesh result = collapsed(grid, byMiddle(value), options);
  CHECK(result.report.end == HtmCollapseEnd::noFace);
  CHECK(result.report.facesBefore == 512);
  CHECK(result.report.maxBefore > 1.1);
  CHECK(test::areaOf(result.mesh) == Approx(256.0));
  std::size_t inside = 0, outside = 0;
  double smallInside = 0;
  for (std::uint32_t f = 0; f < result.mesh.triangles.size(); ++f) {
    const glm::dvec3 p = middleOf(result.mesh, f);
    CHECK(result.differences[f] == value(p));
    (p.x < 5 ? inside : outside) += p.x < 5 || p.x > 9;
    if (p.x < 5 && test::areaOf({result.mesh.positions, {result.mesh.triangles[f]}}) < 3.0) ++smallInside;
  }
  CHECK(outside == 16 * 2 * 7);  // unchanged
  CHECK(inside < 40);            // 160 at the start
  CHECK(smallInside <= double(result.report.refused));
  // Unaffected faces are not evaluated again.
  CHECK(result.report.evaluated < 512 + 14 * result.report.collapses);
}

TEST_CASE("the face with the largest difference is collapsed first") {
  HtmCollapseOptions options;
  options.faceArea = 1.0;
  options.maxCollapses = 1;
  const auto nearTo = [](glm::dvec3 centre) {
    return byMiddle([centre](glm::dvec3 p) { return 1.0 / (1.0 + glm::distance(p, centre)); });
  };
  const glm::dvec3 centre(5.3, 5.6, 0);
  const CollapsedMesh result = collapsed(test::flatGrid(10), nearTo(centre), options);
  CHECK(result.report.collapses == 1);
  CHECK(result.report.end == HtmCollapseEnd::cap);
  CHECK(result.report.facesAfter == 198);
  // An edge of the face nearest to `centre` collapsed to a new point: one of the face's three corners remains.
  std::size_t corners = 0;
  for (const glm::dvec3& p : result.mesh.positions)
    corners += p == glm::dvec3(5, 5, 0) || p == glm::dvec3(5, 6, 0) || p == glm::dvec3(6, 6, 0);
  CHECK(corners == 1);
}

TEST_CASE("faces with unknown differences are not collapsed") {
  HtmCollapseOptions options;
  options.faceArea = 10.0;
  const TriangleMesh grid = test::flatGrid(6);
  for (const double value : {kNaN, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    const CollapsedMesh result = collapsed(grid, byMiddle([value](glm::dvec3) { return value; }), options);
    CHECK(result.mesh == grid);
    CHECK(result.report.unknown == 72);
  }
  CHECK(collapsed(grid, byMiddle([](glm::dvec3 p) { return p.x < 3 ? 1.0 : kNaN; }), options).report.collapses > 5);
}

TEST_CASE("collapsing respects the limits of difference, face area and count", "[N15]") {
  const auto one = byMiddle([](glm::dvec3) { return 1.0; });
  const TriangleMesh grid = test::flatGrid(6);
  HtmCollapseOptions options;
  options.faceArea = 10.0;
  options.floor = 1.0;
  CHECK(collapsed(grid, one, options).mesh == grid);
  options.floor = 0;
  options.faceArea = 0.5;  // the limit equals the area of the faces
  CHECK(collapsed(grid, one, options).mesh == grid);
  options.faceArea = 10.0;
  options.maxCollapses = 0;
  CHECK(collapsed(grid, one, options).mesh == grid);
  options.maxCollapses = 7;
  CHECK(collapsed(grid, one, options).report.collapses == 7);
}

TEST_CASE("batches need fewer calls for a similar result") {
  HtmCollapseOptions options;
  options.faceArea = 0.02;
  std::size_t calls = 0;
  const FaceDifferences differences = [&](const TriangleMesh&, std::span<const std::uint32_t> faces) {
    ++calls;
    return std::vector<double>(faces.size(), 1.0);
  };
  const CollapsedMesh single = collapsed(test::sphere(40), differences, options);
  CHECK(calls == single.report.collapses + 1);
  const std::size_t callsSingle = calls;
  calls = 0;
  options.batch = 32;
  const CollapsedMesh batches = collapsed(test::sphere(40), differences, options);
  CHECK(calls < callsSingle / 10);
  CHECK(double(batches.report.facesAfter) == Approx(double(single.report.facesAfter)).epsilon(0.3));
}

TEST_CASE("collapses of a batch do not touch each other") {
  // A collapse doubles the area of a square's half; adjacent collapses would enlarge the half further.
  HtmCollapseOptions options;
  options.faceArea = 10.0;
  options.batch = 1000;
  std::size_t calls = 0;
  double largest = 0;
  const FaceDifferences differences = [&](const TriangleMesh& mesh, std::span<const std::uint32_t> faces) {
    if (++calls == 2)
      for (const std::uint32_t f : faces)
        largest = std::max(largest, test::areaOf({mesh.positions, {mesh.triangles[f]}}));
    return std::vector<double>(faces.size(), calls == 1 ? 1.0 : kNaN);
  };
  CHECK(collapsed(test::flatGrid(20), differences, options).report.collapses > 20);
  CHECK(calls > 1);
  CHECK(largest > 0.5);
  CHECK(largest <= 1.0 + 1e-9);
}

TEST_CASE("the result has no face left to collapse") {
  HtmCollapseOptions options;
  for (const double area : {0.02, 0.1, 0.5}) {
    options.faceArea = area;
    const auto value = byMiddle([](glm::dvec3 p) { return 2.0 + std::sin(7 * p.x) + std::sin(9 * p.y + p.z); });
    const CollapsedMesh result = collapsed(test::sphere(24), value, options);
    CHECK(result.report.collapses > 20);
    CHECK(collapsed(result.mesh, value, options).report.collapses == 0);
  }
}

TEST_CASE("collapsing ends for any mesh and any differences", "[N15][T24]") {
  std::mt19937 random(9);
  HtmCollapseOptions options;
  options.faceArea = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < 20; ++trial) {
    TriangleMesh mesh = trial % 2 ? test::sphere(16) : test::flatGrid(8);
    if (trial >= 10) {
      mesh.triangles.clear();
      for (int f = 0; f < 150; ++f)
        mesh.triangles.emplace_back(random() % 40, random() % 40, random() % mesh.positions.size());
    }
    options.batch = 1 + random() % 5;
    const CollapsedMesh result = collapsed(
        mesh,
        [&](const TriangleMesh&, std::span<const std::uint32_t> faces) {
          std::vector<double> values(faces.size());
          for (double& v : values) v = random() % 4 == 0 ? kNaN : double(random() % 100) - 20;
          return values;
        },
        options);
    CHECK(result.report.end == HtmCollapseEnd::noFace);
  }
  CHECK(collapsed({}, byMiddle([](glm::dvec3) { return 1.0; }), options).mesh == TriangleMesh{});
}

TEST_CASE("wrong counts of differences and invalid options are rejected, and collapsing can be cancelled") {
  const auto one = byMiddle([](glm::dvec3) { return 1.0; });
  const auto code = [&](const FaceDifferences& differences, const HtmCollapseOptions& options) {
    return test::errorOf([&] { collapseDifferences(test::sphere(16), differences, options); }).code();
  };
  HtmCollapseOptions options;
  options.faceArea = 1.0;
  const FaceDifferences few = [](const TriangleMesh&, std::span<const std::uint32_t>) {
    return std::vector<double>(1);
  };
  CHECK(code(few, options) == ErrorCode::invalidInput);
  for (const double wrong : {kNaN, -1.0}) {
    options.faceArea = wrong;
    CHECK(code(one, options) == ErrorCode::invalidInput);
  }
  options.faceArea = 1.0;
  options.floor = kNaN;
  CHECK(code(one, options) == ErrorCode::invalidInput);
  options.floor = 0;
  options.batch = 0;
  CHECK(code(one, options) == ErrorCode::invalidInput);
  options.batch = 1;
  options.progress = [](const Progress& p) { return p.done < 3; };
  CHECK(code(one, options) == ErrorCode::cancelled);
}

}  // namespace
}  // namespace ibr
