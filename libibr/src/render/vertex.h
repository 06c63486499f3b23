// SPDX-License-Identifier: Apache-2.0
// What a vertex of a morphing mesh is to the renderer (ARCHITECTURE §5, "Texture coordinates, one rule").
#pragma once

#include "ibr/scene.h"

namespace ibr {

/// q_i = a_i·r_i: the vertex in member i's camera axes, at the scale that it shares with ρ.
inline glm::dvec3 memberPoint(const Scene& scene, const Cell& cell, std::size_t member, std::size_t point) {
  return unproject(scene.nodes[cell.members[member]].camera.intrinsics, cell.mesh.match[member][point]) *
         double(cell.mesh.ratio[member][point]);
}

}  // namespace ibr
