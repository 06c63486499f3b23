// SPDX-License-Identifier: Apache-2.0
#include "author/surface/collapse_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ibr {
namespace {

bool has(const glm::uvec3& face, std::uint32_t vertex) {
  return face.x == vertex || face.y == vertex || face.z == vertex;
}

// Number of faces at `vertex` that also have `other`.
std::size_t facesBetween(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, std::uint32_t other) {
  return std::size_t(
      std::count_if(faces.begin(), faces.end(), [&](std::uint32_t f) { return has(mesh.triangles[f], other); }));
}

}  // namespace

CollapseMesh::CollapseMesh(TriangleMesh mesh)
    : mesh_(std::move(mesh)), facesAt_(mesh_.positions.size()), liveFaces_(mesh_.triangles.size()) {
  for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) facesAt_[mesh_.triangles[f][k]].push_back(f);
}

std::vector<std::uint32_t> CollapseMesh::neighbours(std::uint32_t vertex) const {
  std::vector<std::uint32_t> result;
  for (const std::uint32_t f : facesAt_[vertex])
    for (int k = 0; k < 3; ++k)
      if (const std::uint32_t other = mesh_.triangles[f][k]; other != vertex) result.push_back(other);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

bool CollapseMesh::isBorder(std::uint32_t vertex) const {
  for (const std::uint32_t other : neighbours(vertex))
    if (facesBetween(mesh_, facesAt_[vertex], other) == 1) return true;
  return false;
}

glm::dvec3 CollapseMesh::normal(const glm::uvec3& face) const {
  const glm::dvec3 a = mesh_.positions[face.x];
  return glm::cross(mesh_.positions[face.y] - a, mesh_.positions[face.z] - a);
}

double CollapseMesh::area(std::uint32_t face) const {
  return 0.5 * glm::length(normal(mesh_.triangles[face]));
}

Quadric CollapseMesh::planesAt(std::uint32_t vertex) const {
  Quadric sum;
  const glm::dvec3 at = mesh_.positions[vertex];
  for (const std::uint32_t f : facesAt_[vertex]) {
    const glm::dvec3 product = normal(mesh_.triangles[f]);
    const double length = glm::length(product);
    if (!(length > 0)) continue;
    sum.addPlane(product / length, at, length);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = mesh_.triangles[f][k];
      if (other == vertex || facesBetween(mesh_, facesAt_[vertex], other) != 1) continue;
      constexpr double kBorderWeight = 10;
      const glm::dvec3 along = mesh_.positions[other] - at;
      sum.addPlane(glm::normalize(glm::cross(along, product)), at, kBorderWeight * glm::dot(along, along));
    }
  }
  return sum;
}

bool CollapseMesh::keepsTopology(std::uint32_t a, std::uint32_t b) const {
  const std::size_t shared = facesBetween(mesh_, facesAt_[a], b);
  if (a == b || shared < 1 || shared > 2) return false;
  if (shared == 2 && isBorder(a) && isBorder(b)) return false;
  const std::vector<std::uint32_t> ofA = neighbours(a), ofB = neighbours(b);
  std::vector<std::uint32_t> both;
  std::set_intersection(ofA.begin(), ofA.end(), ofB.begin(), ofB.end(), std::back_inserter(both));
  if (both.size() != shared) return false;
  // Reject an edge opposite to both ends: a tetrahedron would fold flat, a lone triangle would vanish.
  if (shared == 2) {
    const auto opposite = [&](std::uint32_t vertex) {
      return std::any_of(facesAt_[vertex].begin(), facesAt_[vertex].end(), [&](std::uint32_t f) {
        return has(mesh_.triangles[f], both[0]) && has(mesh_.triangles[f], both[1]);
      });
    };
    return !(opposite(a) && opposite(b));
  }
  return facesBetween(mesh_, facesAt_[a], both[0]) > 1 || facesBetween(mesh_, facesAt_[b], both[0]) > 1;
}

bool CollapseMesh::keepsNormals(std::uint32_t a, std::uint32_t b, glm::dvec3 to, double minCosine) const {
  for (const auto& [vertex, other] : {std::pair(a, b), std::pair(b, a)})
    for (const std::uint32_t f : facesAt_[vertex]) {
      const glm::uvec3& t = mesh_.triangles[f];
      if (has(t, other)) continue;
      std::array<glm::dvec3, 3> corner;
      for (int k = 0; k < 3; ++k) corner[std::size_t(k)] = t[k] == vertex ? to : mesh_.positions[t[k]];
      const glm::dvec3 before = normal(t), after = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(corner[k], corner[(k + 1) % 3]));
      constexpr double kMinThickness = 1e-3;  // height over longest edge, unless it was as thin before
      const double length = glm::length(after), was = glm::length(before);
      if (!(length > 0)) return false;
      if (length < kMinThickness * longest * longest && length < was) return false;
      if (was > 0 && !(glm::dot(before, after) >= minCosine * was * length)) return false;
    }
  return true;
}

glm::dvec3 CollapseMesh::placement(std::uint32_t a, std::uint32_t b, const Quadric& quadric) const {
  const bool aIsBorder = isBorder(a), bIsBorder = isBorder(b);
  if (aIsBorder != bIsBorder) return mesh_.positions[aIsBorder ? a : b];
  return quadric.minimum(0.5 * (mesh_.positions[a] + mesh_.positions[b]));
}

void CollapseMesh::collapse(std::uint32_t a, std::uint32_t b, glm::dvec3 to) {
  const auto drop = [&](std::uint32_t vertex, std::uint32_t face) { std::erase(facesAt_[vertex], face); };
  for (const std::uint32_t f : std::vector(facesAt_[b])) {
    glm::uvec3& t = mesh_.triangles[f];
    if (has(t, a)) {
      for (int k = 0; k < 3; ++k) drop(t[k], f);
      t = glm::uvec3(a);
      --liveFaces_;
    } else {
      for (int k = 0; k < 3; ++k)
        if (t[k] == b) t[k] = a;
      facesAt_[a].push_back(f);
    }
  }
  facesAt_[b].clear();
  mesh_.positions[a] = to;
}

TriangleMesh CollapseMesh::compact() const {
  TriangleMesh result;
  std::vector<std::uint32_t> name(mesh_.positions.size(), 0);
  for (std::size_t v = 0; v < name.size(); ++v) {
    if (facesAt_[v].empty()) continue;
    name[v] = std::uint32_t(result.positions.size());
    result.positions.push_back(mesh_.positions[v]);
  }
  for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f)
    if (isAlive(f)) {
      const glm::uvec3& t = mesh_.triangles[f];
      result.triangles.emplace_back(name[t.x], name[t.y], name[t.z]);
    }
  return result;
}

}  // namespace ibr
