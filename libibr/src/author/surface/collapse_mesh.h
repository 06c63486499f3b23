// SPDX-License-Identifier: Apache-2.0
// A mesh for edge collapses: two vertices become one, and the faces at the edge vanish.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/geometry/quadric.h"
#include "ibr/htm_model.h"

namespace ibr {

/// Vertices and faces keep their indices; a dead face has three equal corners.
class CollapseMesh {
 public:
  /// Precondition: a result of repairMesh.
  explicit CollapseMesh(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  std::size_t faceCount() const { return liveFaces_; }
  bool isAlive(std::uint32_t face) const { return mesh_.triangles[face].x != mesh_.triangles[face].y; }
  std::span<const std::uint32_t> facesAt(std::uint32_t vertex) const { return facesAt_[vertex]; }
  std::vector<std::uint32_t> neighbours(std::uint32_t vertex) const;  // ascending
  bool isBorder(std::uint32_t vertex) const;
  double area(std::uint32_t face) const;

  /// Sums the planes of the faces at a vertex, weighted by area. Border edges add planes perpendicular to their faces,
  /// which keep the border in place.
  Quadric planesAt(std::uint32_t vertex) const;

  /// True if {a, b} is an edge whose collapse leaves a manifold of the same topology (the link condition: Dey,
  /// Edelsbrunner, Guha, Nekhayev, Topology preserving edge contraction, 1999).
  bool keepsTopology(std::uint32_t a, std::uint32_t b) const;

  /// True if, with a and b moved to `to`, no remaining face's normal vanishes or turns by more than the angle with
  /// cosine `minCosine`.
  bool keepsNormals(std::uint32_t a, std::uint32_t b, glm::dvec3 to, double minCosine) const;

  /// Returns the position of the merged vertex with the least deviation from `quadric`'s planes: at the border vertex
  /// if only one end is on the border; near the edge's midpoint where the planes leave freedom.
  glm::dvec3 placement(std::uint32_t a, std::uint32_t b, const Quadric& quadric) const;

  /// Merges b into a, at `to`.
  void collapse(std::uint32_t a, std::uint32_t b, glm::dvec3 to);

  /// Returns the mesh without dead faces and unused vertices, in the same order.
  TriangleMesh compact() const;

 private:
  glm::dvec3 normal(const glm::uvec3& face) const;  // length: twice the area

  TriangleMesh mesh_;
  std::vector<std::vector<std::uint32_t>> facesAt_;
  std::size_t liveFaces_;
};

}  // namespace ibr
