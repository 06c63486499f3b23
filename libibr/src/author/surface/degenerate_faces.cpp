// SPDX-License-Identifier: Apache-2.0
#include "author/surface/degenerate_faces.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <vector>

namespace ibr {
namespace {

// Index of the corner at which the longest edge starts.
int longestEdge(const TriangleMesh& mesh, const glm::uvec3& face) {
  int longest = 0;
  double most = -1;
  for (int k = 0; k < 3; ++k)
    if (const double length = glm::distance(mesh.positions[face[k]], mesh.positions[face[(k + 1) % 3]]);
        length > most) {
      most = length;
      longest = k;
    }
  return longest;
}

using HalfEdges = std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t>;  // half-edge to its face

// Flips the longest edge of `face`, or drops a border face; returns false if the mesh would not stay manifold.
bool removeFace(TriangleMesh& mesh, std::size_t face, HalfEdges& faceOf, std::vector<char>& gone) {
  const glm::uvec3 t = mesh.triangles[face];
  const int k = longestEdge(mesh, t);
  const std::uint32_t a = t[k], b = t[(k + 1) % 3], middle = t[(k + 2) % 3];
  const auto found = faceOf.find({b, a});
  if (found == faceOf.end()) {
    for (int e = 0; e < 3; ++e) faceOf.erase({t[e], t[(e + 1) % 3]});
    gone[face] = 1;
    return true;
  }
  const std::size_t neighbour = found->second;
  const glm::uvec3 u = mesh.triangles[neighbour];
  std::uint32_t apex = u.x;
  for (int e = 0; e < 3; ++e)
    if (u[e] != a && u[e] != b) apex = u[e];
  const glm::uvec3 first(a, apex, middle), second(apex, b, middle);
  if (apex == middle || faceOf.contains({middle, apex}) || faceOf.contains({apex, middle}) ||
      isDegenerate(mesh, first) || isDegenerate(mesh, second))
    return false;
  for (int e = 0; e < 3; ++e) {
    faceOf.erase({t[e], t[(e + 1) % 3]});
    faceOf.erase({u[e], u[(e + 1) % 3]});
  }
  mesh.triangles[face] = first;
  mesh.triangles[neighbour] = second;
  for (const std::size_t f : {face, neighbour})
    for (int e = 0; e < 3; ++e) faceOf[{mesh.triangles[f][e], mesh.triangles[f][(e + 1) % 3]}] = f;
  return true;
}

}  // namespace

bool isDegenerate(const TriangleMesh& mesh, const glm::uvec3& face) {
  const int k = longestEdge(mesh, face);
  const glm::dvec3 a = mesh.positions[face[k]];
  const glm::dvec3 along = mesh.positions[face[(k + 1) % 3]] - a, to = mesh.positions[face[(k + 2) % 3]] - a;
  constexpr double kFlat = 1e-9;
  // Negated, so that faces with non-finite values count as flat.
  return !(glm::length(glm::cross(along, to)) > kFlat * glm::dot(along, along));
}

DegenerateFaceCounts removeDegenerateFaces(TriangleMesh& mesh) {
  DegenerateFaceCounts result;
  std::vector<std::size_t> flat;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if (isDegenerate(mesh, mesh.triangles[f])) flat.push_back(f);
  if (flat.empty()) return result;
  HalfEdges faceOf;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int e = 0; e < 3; ++e) faceOf[{mesh.triangles[f][e], mesh.triangles[f][(e + 1) % 3]}] = f;
  std::vector<char> gone(mesh.triangles.size(), 0);
  // Each success leaves one flat face fewer, and may allow another one's edge to be flipped.
  for (bool progress = true; progress && !flat.empty();) {
    progress = false;
    std::vector<std::size_t> left;
    for (const std::size_t f : flat) {
      if (!isDegenerate(mesh, mesh.triangles[f])) continue;
      if (removeFace(mesh, f, faceOf, gone)) {
        ++result.removed;
        progress = true;
      } else {
        left.push_back(f);
      }
    }
    flat = std::move(left);
  }
  result.left = flat.size();
  std::size_t kept = 0;
  for (std::size_t f = 0; f < gone.size(); ++f)
    if (!gone[f]) mesh.triangles[kept++] = mesh.triangles[f];
  mesh.triangles.resize(kept);
  return result;
}

}  // namespace ibr
