// SPDX-License-Identifier: Apache-2.0
// Which meshes a view cannot see ([T] §2.5.2: cells outside the frustum are not drawn).
#pragma once

#include <array>

#include "ibr/renderer.h"
#include "render/barycentric.h"

namespace ibr {

/// Inward normals of the four side planes of a pinhole's frustum, world axes; all pass through its centre.
std::array<glm::dvec3, 4> frustum(const Camera& view);

/// False only if every vertex lies outside of one plane, for a camera at `eye` with these weights of position.
bool mayBeVisible(const Scene& scene, const Cell& cell, const CellBounds& bounds,
                  const std::array<glm::dvec3, 4>& planes, const Weights& weights, Morph morph, glm::dvec3 eye);

}  // namespace ibr
