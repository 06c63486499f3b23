// SPDX-License-Identifier: Apache-2.0
// A mesh that edges are collapsed in: two vertices become one, the faces at the edge vanish.
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
  /// Precondition: what repairMesh gives.
  explicit CollapseMesh(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  std::size_t faceCount() const { return liveFaces_; }
  bool isAlive(std::uint32_t face) const { return mesh_.triangles[face].x != mesh_.triangles[face].y; }
  std::span<const std::uint32_t> facesAt(std::uint32_t vertex) const { return facesAt_[vertex]; }
  std::vector<std::uint32_t> neighbours(std::uint32_t vertex) const;  // ascending
  bool isBorder(std::uint32_t vertex) const;
  double area(std::uint32_t face) const;

  /// The planes of the faces at a vertex, weighted by area, and along its border edges the planes upright on their
  /// faces, which hold a border in its place.
  Quadric planesAt(std::uint32_t vertex) const;

  /// Whether {a, b} is an edge whose collapse leaves a manifold of the same topology (the link condition: Dey,
  /// Edelsbrunner, Guha, Nekhayev, Topology preserving edge contraction, 1999).
  bool keepsTopology(std::uint32_t a, std::uint32_t b) const;

  /// Whether with a and b moved to `to` the normal of no remaining face turns by more than the angle with cosine
  /// `leastCosine` or vanishes.
  bool keepsNormals(std::uint32_t a, std::uint32_t b, glm::dvec3 to, double leastCosine) const;

  /// Where the merged vertex deviates least from the planes in `quadric`: on the border if one end is, on the edge's
  /// middle as far as the planes leave it free.
  glm::dvec3 placement(std::uint32_t a, std::uint32_t b, const Quadric& quadric) const;

  /// b becomes a, at `to`.
  void collapse(std::uint32_t a, std::uint32_t b, glm::dvec3 to);

  /// Without what is dead or unused, in the same order.
  TriangleMesh compact() const;

 private:
  glm::dvec3 normal(const glm::uvec3& face) const;  // twice the area long

  TriangleMesh mesh_;
  std::vector<std::vector<std::uint32_t>> facesAt_;
  std::size_t liveFaces_;
};

}  // namespace ibr
