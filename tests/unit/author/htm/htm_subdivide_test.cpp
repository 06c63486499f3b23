// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_subdivide.h"

#include <catch2/catch.hpp>
#include <random>

#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

// Subdivides an oriented manifold with integer corners, and checks the invariants of every result.
SubdividedMesh subdivided(const TriangleMesh& mesh, const std::vector<std::uint8_t>& chosen) {
  SubdividedMesh result = subdivideFaces(mesh, chosen);
  CHECK(test::isOrientedManifold(result.mesh));  // a T-junction would leave a border inside the mesh
  CHECK(test::eulerNumber(result.mesh) == test::eulerNumber(mesh));
  std::vector<double> area(mesh.triangles.size(), 0.0);
  REQUIRE(result.faceOf.size() == result.mesh.triangles.size());
  for (std::size_t f = 0; f < result.faceOf.size(); ++f) {
    const TriangleMesh face{result.mesh.positions, {result.mesh.triangles[f]}};
    area[result.faceOf[f]] += test::areaOf(face);
    if (f > 0) CHECK(result.faceOf[f - 1] <= result.faceOf[f]);
  }
  for (std::size_t f = 0; f < area.size(); ++f) CHECK(area[f] == test::areaOf({mesh.positions, {mesh.triangles[f]}}));
  REQUIRE(result.parents.size() == result.mesh.positions.size() - mesh.positions.size());
  for (std::size_t v = 0; v < result.mesh.positions.size(); ++v) {
    if (v < mesh.positions.size()) {
      CHECK(result.mesh.positions[v] == mesh.positions[v]);
    } else {
      const glm::uvec2 parents = result.parents[v - mesh.positions.size()];
      CHECK(parents.x < parents.y);
      CHECK(result.mesh.positions[v] == 0.5 * (mesh.positions[parents.x] + mesh.positions[parents.y]));
    }
  }
  return result;
}

// On borders new vertices halve edges of the input, so the border's length is preserved.
double borderLength(const TriangleMesh& mesh) {
  std::map<std::set<std::uint32_t>, int> faces;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++faces[{t[k], t[(k + 1) % 3]}];
  double length = 0;
  for (const auto& [edge, count] : faces)
    if (count == 1) length += glm::distance(mesh.positions[*edge.begin()], mesh.positions[*edge.rbegin()]);
  return length;
}

TEST_CASE("a face beside chosen faces is split at its divided edges, for each set of edges", "[N15]") {
  // One face in the middle and one at each edge; integer corners keep areas exact.
  const TriangleMesh star{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {4, -8, 0}, {8, 8, 0}, {-8, 4, 0}},
                          {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}, {0, 2, 5}}};
  for (unsigned mask = 0; mask < 8; ++mask) {
    CAPTURE(mask);
    std::vector<std::uint8_t> chosen(4, 0);
    for (unsigned k = 0; k < 3; ++k) chosen[k + 1] = mask >> k & 1u;
    const SubdividedMesh result = subdivided(star, chosen);
    const auto marked = std::count(chosen.begin(), chosen.end(), 1);
    CHECK(std::count(result.faceOf.begin(), result.faceOf.end(), 0u) == marked + 1);
    for (std::uint32_t f = 1; f < 4; ++f)
      CHECK(std::count(result.faceOf.begin(), result.faceOf.end(), f) == (chosen[f] ? 4 : 1));
    CHECK(borderLength(result.mesh) == Approx(borderLength(star)).epsilon(1e-14));
    chosen[0] = 1;
    const std::vector<std::uint32_t> faceOf = subdivided(star, chosen).faceOf;
    CHECK(std::count(faceOf.begin(), faceOf.end(), 0u) == 4);
  }
}

TEST_CASE("the rest of a face with two divided edges is split along the shorter diagonal") {
  for (const double far : {1.0, 64.0}) {
    const TriangleMesh mesh{{{0, 0, 0}, {4, 0, 0}, {2, far, 0}, {2, -4, 0}, {far, far, 0}},
                            {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}}};
    const SubdividedMesh result = subdivided(mesh, {0, 1, 1});
    const glm::dvec3 first = 0.5 * (mesh.positions[0] + mesh.positions[1]);
    const glm::dvec3 second = 0.5 * (mesh.positions[1] + mesh.positions[2]);
    const double longer = std::max(glm::distance(mesh.positions[0], second), glm::distance(mesh.positions[2], first));
    for (std::size_t f = 0; f < 3; ++f)
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a = result.mesh.positions[result.mesh.triangles[f][k]];
        const glm::dvec3 b = result.mesh.positions[result.mesh.triangles[f][(k + 1) % 3]];
        const bool isDiagonal = (a == mesh.positions[0] && b == second) || (b == mesh.positions[0] && a == second) ||
                                (a == mesh.positions[2] && b == first) || (b == mesh.positions[2] && a == first);
        if (isDiagonal) CHECK(glm::distance(a, b) < longer);
      }
  }
}

TEST_CASE("any choice of faces keeps the mesh's shape and topology", "[N15]") {
  std::mt19937 random(2);
  for (const TriangleMesh& mesh : {test::cube(), test::flatGrid(4)})
    for (int trial = 0; trial < 30; ++trial) {
      std::vector<std::uint8_t> chosen(mesh.triangles.size());
      for (std::uint8_t& c : chosen) c = random() % 3 == 0;
      const SubdividedMesh result = subdivided(mesh, chosen);
      CHECK(test::areaOf(result.mesh) == Approx(test::areaOf(mesh)).epsilon(1e-14));
      CHECK(borderLength(result.mesh) == Approx(borderLength(mesh)).epsilon(1e-14));
    }
  TriangleMesh mesh = test::cube();
  for (int depth = 0; depth < 4; ++depth)
    mesh = subdivided(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1)).mesh;
  CHECK(mesh.triangles.size() == 12 * 256);
  CHECK(subdivided(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 0)).mesh == mesh);
}

TEST_CASE("non-manifold meshes are subdivided, and invalid arguments are rejected", "[N15]") {
  // Three faces share one edge, and its midpoint.
  const TriangleMesh book{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 2}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
  const std::vector<std::uint8_t> first{1, 0, 0};
  const SubdividedMesh result = subdivideFaces(book, first);
  CHECK(result.mesh.triangles.size() == 4 + 2 + 2);
  CHECK(result.parents.size() == 3);
  CHECK(subdivideFaces({}, {}).mesh == TriangleMesh{});
  CHECK(test::errorOf([&] { subdivideFaces(test::cube(), first); }).code() == ErrorCode::invalidInput);
  const std::vector<std::uint8_t> one{1};
  CHECK(test::errorOf([&] {
          subdivideFaces({{glm::dvec3(0.0)}, {{0, 0, 1}}}, one);
        }).code() == ErrorCode::invalidInput);
}

}  // namespace
TEST_CASE("complements of new vertices are the mean of their parents' complements, pair by pair") {
  std::vector<glm::vec2> complements;
  for (int pair = 0; pair < 4; ++pair)
    for (int v = 0; v < 3; ++v) complements.emplace_back(10 * pair + v, -v * v);
  const std::vector<glm::uvec2> parents{{0, 1}, {1, 2}};
  const auto divided = dividedComplements(complements, 2, 3, parents);
  REQUIRE(divided.size() == 20);
  for (int pair = 0; pair < 4; ++pair) {
    for (int v = 0; v < 3; ++v) CHECK(divided[std::size_t(5 * pair + v)] == complements[std::size_t(3 * pair + v)]);
    CHECK(divided[std::size_t(5 * pair + 3)] == glm::vec2(10 * pair + 0.5, -0.5));
    CHECK(divided[std::size_t(5 * pair + 4)] == glm::vec2(10 * pair + 1.5, -2.5));
  }
  CHECK(dividedComplements({}, 2, 3, parents).empty());
}

}  // namespace ibr
