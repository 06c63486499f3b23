// SPDX-License-Identifier: Apache-2.0
// Frustum culling: finds meshes that a view cannot see ([T] §2.5.2: cells outside the frustum are not drawn).
#pragma once

#include <array>

#include "ibr/frame_plan.h"
#include "render/plan/barycentric.h"

namespace ibr {

/// Inward normals of the four side planes of a pinhole's frustum, world axes; all pass through its centre.
std::array<glm::dvec3, 4> frustum(const Camera& view);

/// Parameters with which a mesh is drawn for a camera at `eye`.
struct Placement {
  Weights weights;  // of position
  Morph morph;
  glm::dvec3 eye;
  Correction correction;
};

/// Returns false only if every vertex lies outside one plane by more than `margin` (radians), at these weights.
bool mayBeVisible(const Scene& scene, const Cell& cell, const CellBounds& bounds,
                  const std::array<glm::dvec3, 4>& planes, const Placement& placement, double margin = 0);

}  // namespace ibr
