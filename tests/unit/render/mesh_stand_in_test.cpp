// SPDX-License-Identifier: Apache-2.0
#include "render/resident/mesh_stand_in.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace ibr;

namespace {

// A cell whose mesh is a grid of squares², on a plane, as seen by each of its members.
struct GridMesh {
  explicit GridMesh(std::size_t members, int squares, bool panorama = false) : side(squares + 1) {
    for (std::size_t i = 0; i < members; ++i) {
      Node& node = scene.nodes.emplace_back();
      node.name = std::to_string(i);
      node.camera.intrinsics = pinholeFromFov(400, 300, 1.0);
      if (panorama) node.camera.intrinsics.model = CameraModel::equirectangular;
      cell.members.push_back(std::uint32_t(i));
    }
    MorphMesh& mesh = cell.mesh;
    mesh.match.resize(members);
    mesh.ratio.assign(members, std::vector<float>(std::size_t(side * side), 1.0f));
    mesh.inverseDistance.assign(std::size_t(side * side), 0.1f);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        for (std::size_t i = 0; i < members; ++i)
          mesh.match[i].emplace_back(20 + 360.0f * float(x) / float(squares) + float(i),
                                     10 + 280.0f * float(y) / float(squares));
    for (int y = 0; y < squares; ++y)
      for (int x = 0; x < squares; ++x) {
        const auto a = std::uint32_t(y * side + x), b = a + 1, c = a + std::uint32_t(side), d = c + 1;
        mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
      }
    mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
    mesh.ecc.assign(mesh.triangles.size(), 1.0f);
  }

  std::vector<glm::uvec3> drawn() const { return drawnTriangles(scene, cell); }
  MeshPart standIn() const { return meshStandIn(cell, drawn()); }

  Scene scene;
  Cell cell;
  int side;
};

double area(const Cell& cell, const std::vector<glm::uvec3>& triangles) {
  const auto& at = cell.mesh.match[0];
  double sum = 0;
  for (const glm::uvec3 t : triangles) {
    const glm::dvec2 a = at[t.y] - at[t.x], b = at[t.z] - at[t.x];
    sum += std::abs(a.x * b.y - a.y * b.x) / 2;
  }
  return sum;
}

// In vertices of the mesh.
std::vector<glm::uvec3> trianglesOf(const MeshPart& part) {
  std::vector<glm::uvec3> triangles;
  for (const glm::uvec3 t : part.triangles)
    triangles.emplace_back(part.points[t.x], part.points[t.y], part.points[t.z]);
  return triangles;
}

void checkValid(const MeshPart& part, const Cell& cell) {
  CHECK(part.triangles.size() <= kMaxStandInTriangles);
  CHECK(std::ranges::is_sorted(part.points));
  CHECK(std::ranges::adjacent_find(part.points) == part.points.end());
  for (const std::uint32_t p : part.points) CHECK(p < cell.mesh.vertexCount());
  for (const glm::uvec3 t : part.triangles) {
    CHECK(std::max({t.x, t.y, t.z}) < part.points.size());
    CHECK((t.x != t.y && t.y != t.z && t.z != t.x));
  }
}

}  // namespace

TEST_CASE(
    "a stand-in of a plane has at most 64 triangles and covers at least 90 % of the plane, for every kind of cell") {
  const std::size_t members = GENERATE(std::size_t(1), std::size_t(2), std::size_t(3), std::size_t(4));
  const int squares = GENERATE(6, 7, 16, 51, 100);
  const bool panorama = GENERATE(false, true);
  CAPTURE(members, squares, panorama);
  const GridMesh mesh(members, squares, panorama);
  const MeshPart part = mesh.standIn();
  checkValid(part, mesh.cell);
  CHECK(part.triangles.size() < mesh.drawn().size());
  CHECK(area(mesh.cell, trianglesOf(part)) >= 0.9 * area(mesh.cell, mesh.drawn()));
  CHECK(area(mesh.cell, trianglesOf(part)) <= 1.001 * area(mesh.cell, mesh.drawn()));
}

TEST_CASE("a stand-in of a disc covers at least 90 % of the disc") {
  GridMesh mesh(3, 60);
  const glm::vec2 middle(200, 150);
  std::erase_if(mesh.cell.mesh.triangles,
                [&](glm::uvec3 t) { return glm::distance(mesh.cell.mesh.match[0][t.x], middle) > 130; });
  mesh.cell.mesh.tier.resize(mesh.cell.mesh.triangles.size());
  const MeshPart part = mesh.standIn();
  checkValid(part, mesh.cell);
  CHECK(area(mesh.cell, trianglesOf(part)) >= 0.9 * area(mesh.cell, mesh.drawn()));
}

TEST_CASE("the stand-in of a mesh of at most 64 triangles is the mesh") {
  const int squares = GENERATE(1, 5);
  const GridMesh mesh(2, squares);
  const MeshPart part = mesh.standIn();
  CHECK(part.points.size() == mesh.cell.mesh.vertexCount());
  CHECK(part.triangles == mesh.cell.mesh.triangles);
}

TEST_CASE("empty meshes, meshes without usable triangles and meshes of one triangle have stand-ins") {
  GridMesh mesh(3, 20);
  SECTION("no triangles of tier 0") {
    std::ranges::fill(mesh.cell.mesh.tier, kTierRejected);
    CHECK(mesh.drawn().empty());
    CHECK(mesh.standIn().points.empty());
  }
  SECTION("no triangles and no vertices") {
    mesh.cell.mesh = {};
    mesh.cell.mesh.match.resize(3);
    mesh.cell.mesh.ratio.resize(3);
    CHECK(mesh.drawn().empty());
    CHECK(mesh.standIn().triangles.empty());
  }
  SECTION("rays that do not agree") {
    mesh.scene.nodes[1].camera.pose.rotation = glm::angleAxis(3.0, glm::dvec3(0, 1, 0));
    CHECK(mesh.drawn().empty());
    CHECK(mesh.standIn().triangles.empty());
  }
  SECTION("one triangle") {
    mesh.cell.mesh.triangles = {{40, 3, 7}};
    mesh.cell.mesh.tier = {kTierConsistent};
    const MeshPart part = mesh.standIn();
    CHECK(part.points == std::vector<std::uint32_t>{3, 7, 40});
    CHECK(trianglesOf(part) == mesh.cell.mesh.triangles);
  }
}

TEST_CASE("stand-ins of degenerate meshes are valid") {
  GridMesh mesh(3, 20);
  std::vector<glm::vec2>& at = mesh.cell.mesh.match[0];
  SECTION("all vertices at one pixel") {
    std::ranges::fill(at, glm::vec2(100, 100));
  }
  SECTION("all vertices on a line") {
    for (glm::vec2& p : at) p.y = 100;
  }
  SECTION("folded along the middle") {
    for (glm::vec2& p : at) p.x = std::min(p.x, 400 - p.x);
  }
  SECTION("vertices in random order") {
    for (std::size_t p = 0; p < at.size(); ++p) at[p] = {float(p * 7919 % 397), float(p * 104729 % 293)};
  }
  checkValid(mesh.standIn(), mesh.cell);
}

TEST_CASE("sheets that lie over one another and are not connected stay apart") {
  GridMesh mesh(2, 12);
  const std::size_t count = mesh.cell.mesh.vertexCount(), triangles = mesh.cell.mesh.triangles.size();
  for (auto* values : {&mesh.cell.mesh.match[0], &mesh.cell.mesh.match[1]}) {
    const std::vector<glm::vec2> copy = *values;
    values->insert(values->end(), copy.begin(), copy.end());
  }
  for (auto& ratio : mesh.cell.mesh.ratio) ratio.resize(2 * count, 1.0f);
  mesh.cell.mesh.inverseDistance.resize(2 * count, 0.5f);
  for (std::size_t t = 0; t < triangles; ++t)
    mesh.cell.mesh.triangles.push_back(mesh.cell.mesh.triangles[t] + glm::uvec3(std::uint32_t(count)));
  mesh.cell.mesh.tier.resize(2 * triangles, kTierConsistent);
  const MeshPart part = mesh.standIn();
  checkValid(part, mesh.cell);
  for (const glm::uvec3 t : trianglesOf(part))
    CHECK(((t.x < count) == (t.y < count) && (t.y < count) == (t.z < count)));
  CHECK(area(mesh.cell, trianglesOf(part)) >= 0.9 * area(mesh.cell, mesh.drawn()));
}

TEST_CASE("a mesh of many small pieces is covered by a stand-in that joins them") {
  GridMesh mesh(2, 40);
  MorphMesh apart = mesh.cell.mesh;  // every triangle has vertices of its own
  for (std::size_t i = 0; i < 2; ++i) apart.match[i].clear();
  apart.triangles.clear();
  for (const glm::uvec3 t : mesh.cell.mesh.triangles) {
    const auto first = std::uint32_t(apart.match[0].size());
    for (int v = 0; v < 3; ++v)
      for (std::size_t i = 0; i < 2; ++i) apart.match[i].push_back(mesh.cell.mesh.match[i][t[v]]);
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  apart.inverseDistance.assign(apart.match[0].size(), 0.1f);
  for (auto& ratio : apart.ratio) ratio.assign(apart.match[0].size(), 1.0f);
  mesh.cell.mesh = apart;
  const MeshPart part = mesh.standIn();
  checkValid(part, mesh.cell);
  CHECK(area(mesh.cell, trianglesOf(part)) >= 0.9 * area(mesh.cell, mesh.drawn()));
}

TEST_CASE("stand-ins are deterministic") {
  const GridMesh mesh(3, 33);
  const MeshPart first = mesh.standIn(), second = mesh.standIn();
  CHECK(first.points == second.points);
  CHECK(first.triangles == second.triangles);
}
