// SPDX-License-Identifier: Apache-2.0
// Frustum culling: finds meshes that a view cannot see ([T] §2.5.2: cells outside the frustum are not drawn).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>

#include "ibr/frame_plan.h"
#include "render/plan/barycentric.h"
#include "render/plan/cell_poses.h"

namespace ibr {

/// Inward unit normals of the four side planes of a pinhole's frustum, world axes; all pass through its centre.
std::array<glm::dvec3, 4> frustum(const Camera& view);

/// Returns the maximum of n·x over a box, added to `sum`.
inline double mostInBox(glm::dvec3 n, glm::dvec3 low, glm::dvec3 high, double sum = 0) {
  for (int a = 0; a < 3; ++a) sum += std::max(n[a] * low[a], n[a] * high[a]);
  return sum;
}

/// Parameters with which a mesh is drawn for a camera at `eye`.
struct Placement {
  Weights weights;  // of position
  Morph morph;
  glm::dvec3 eye;
  Correction correction;
};

/// Bounds of the directions D = C·Σ λ_i R_i q_i + ρ·t of a mesh's vertices (correction.h), in chosen axes.
class DirectionBounds {
 public:
  /// `axes`: rotation of the axes to world axes.
  DirectionBounds(const CellPoses& cell, const CellBounds& bounds, const Placement& placement,
                  const glm::dquat& axes = glm::dquat(1, 0, 0, 0));

  /// Returns an upper bound of n·D; bounds each term by itself.
  double most(glm::dvec3 n) const;

  /// Returns an upper bound of |D|.
  double reach() const;

 private:
  struct Member {
    glm::dmat3 turn;       // λ_i times the rotation of the chosen axes to the member's
    glm::dvec3 low, high;  // of q_i
    double weight;         // |λ_i|
  };
  std::array<Member, 4> members_;  // those with a weight other than 0
  std::size_t count_ = 0;
  glm::dvec3 shift_;  // t times the largest ρ
  bool ours_;
};

/// Returns false only if every vertex lies outside one plane by more than `margin` (radians), at these weights.
bool mayBeVisible(const CellPoses& cell, const CellBounds& bounds, const std::array<glm::dvec3, 4>& planes,
                  const Placement& placement, double margin = 0);

}  // namespace ibr
