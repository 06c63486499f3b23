// SPDX-License-Identifier: Apache-2.0
// A vertex of a morphing mesh in the axes of its members' cameras, and the test that its rays agree.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

/// Returns q_i = a_i·r_i: the vertex in member i's camera axes, at the scale that it shares with ρ.
inline glm::dvec3 memberPoint(const Scene& scene, const Cell& cell, std::size_t member, std::size_t point) {
  return unproject(scene.nodes[cell.members[member]].camera.intrinsics, cell.mesh.match[member][point]) *
         double(cell.mesh.ratio[member][point]);
}

/// Returns false if two members' rays to a point differ by more than 120°: their sum has no reliable direction, and
/// triangles with such a point are left out.
inline bool raysAgree(const Scene& scene, const Cell& cell, std::size_t point) {
  std::array<glm::dvec3, 4> rays;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Camera& camera = scene.nodes[cell.members[i]].camera;
    rays[i] = camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][point]);
    for (std::size_t j = 0; j < i; ++j)
      if (glm::dot(rays[i], rays[j]) < -0.5) return false;
  }
  return true;
}

/// Returns raysAgree for each point; triangles with a point that is not usable are left out.
inline std::vector<bool> usablePoints(const Scene& scene, const Cell& cell) {
  std::vector<bool> usable(cell.mesh.vertexCount());
  for (std::size_t p = 0; p < usable.size(); ++p) usable[p] = raysAgree(scene, cell, p);
  return usable;
}

}  // namespace ibr
