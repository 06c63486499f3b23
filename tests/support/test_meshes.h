// SPDX-License-Identifier: Apache-2.0
// Small meshes, and invariants of any mesh after an operation. Implemented independently of the library.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr::test {

/// Corners at 0 or 1 (times size, plus `at`); faces point outwards.
inline TriangleMesh cube(glm::dvec3 at = glm::dvec3(0.0), double size = 1.0) {
  TriangleMesh mesh;
  for (unsigned v = 0; v < 8; ++v) mesh.positions.push_back(at + size * glm::dvec3(v & 1u, v >> 1 & 1u, v >> 2));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// n × n squares in the plane z = 0, facing +z; corners at whole numbers.
inline TriangleMesh flatGrid(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) mesh.positions.emplace_back(x, y, 0.0);
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.emplace_back(a, b, d);
      mesh.triangles.emplace_back(a, d, c);
    }
  return mesh;
}

/// Sphere of radius 1 with two poles and n·(n/2 − 1) other vertices; faces point outwards.
inline TriangleMesh sphere(std::uint32_t n) {
  TriangleMesh mesh;
  const std::uint32_t rows = n / 2 - 1;
  mesh.positions.emplace_back(0, 0, 1);
  for (std::uint32_t r = 1; r <= rows; ++r)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double down = std::numbers::pi * r / (rows + 1), around = 2 * std::numbers::pi * k / n;
      mesh.positions.emplace_back(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down));
    }
  mesh.positions.emplace_back(0, 0, -1);
  const auto last = std::uint32_t(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t r, std::uint32_t k) { return 1 + r * n + k % n; };
  for (std::uint32_t k = 0; k < n; ++k) {
    mesh.triangles.emplace_back(0, at(0, k), at(0, k + 1));
    mesh.triangles.emplace_back(last, at(rows - 1, k + 1), at(rows - 1, k));
    for (std::uint32_t r = 0; r + 1 < rows; ++r) {
      mesh.triangles.emplace_back(at(r, k), at(r + 1, k), at(r + 1, k + 1));
      mesh.triangles.emplace_back(at(r, k), at(r + 1, k + 1), at(r, k + 1));
    }
  }
  return mesh;
}

inline double areaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += 0.5 * glm::length(
                     glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
  return sum;
}

/// Returns vertices − edges + faces.
inline long eulerNumber(const TriangleMesh& mesh) {
  std::set<std::set<std::uint32_t>> edges;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  return long(mesh.positions.size()) - long(edges.size()) + long(mesh.triangles.size());
}

inline std::size_t borderEdges(const TriangleMesh& mesh) {
  std::map<std::set<std::uint32_t>, int> faces;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++faces[{t[k], t[(k + 1) % 3]}];
  std::size_t count = 0;
  for (const auto& [edge, number] : faces) count += number == 1;
  return count;
}

/// Checks that indices are in range, all vertices are used, directed edges are unique and each vertex has one fan.
inline bool isOrientedManifold(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  std::vector<std::map<std::uint32_t, std::uint32_t>> around(mesh.positions.size());
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (a >= mesh.positions.size() || a == b) return false;
      if (!edges.emplace(std::pair(a, b), c).second) return false;
      around[a][b] = c;
    }
  for (const auto& fan : around) {
    if (fan.empty()) return false;
    std::set<std::uint32_t> ends;
    for (const auto& [from, to] : fan) ends.insert(to);
    std::uint32_t start = fan.begin()->first;
    for (const auto& [from, to] : fan)
      if (!ends.contains(from)) start = from;
    std::size_t steps = 0;
    for (auto step = fan.find(start); step != fan.end() && steps < fan.size(); step = fan.find(step->second)) ++steps;
    if (steps != fan.size()) return false;
  }
  return true;
}

}  // namespace ibr::test
