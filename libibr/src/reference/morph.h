// SPDX-License-Identifier: Apache-2.0
// Reference implementation of shaders/render/cell_vertex.glsl in double precision.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "ibr/renderer.h"
#include "ibr/scene.h"

namespace ibr::reference {

/// World direction in which the camera at `eye` sees a vertex, not normalised; (direction, ρ) is homogeneous.
inline glm::dvec3 morph(const Scene& scene, const Cell& cell, std::size_t point, const std::array<double, 4>& position,
                        Morph way, glm::dvec3 eye, const Correction& correction = {}) {
  glm::dvec3 direction(0.0), shift(0.0);
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Camera& camera = scene.nodes[cell.members[i]].camera;
    const double ratio = way == Morph::ours ? double(cell.mesh.ratio[i][point]) : 1.0;
    direction += position[i] * ratio * (camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][point]));
    shift += position[i] * (camera.pose.position - eye);
  }
  if (way == Morph::paper) return correction.rotation * direction;
  // Vector from the eye to the vertex X, times ρ: X − eye = direction / ρ + shift.
  const double inverseDistance = cell.mesh.inverseDistance[point];
  const glm::dvec3 fromPivot = direction + inverseDistance * (shift + (eye - correction.pivot) + correction.shift);
  return correction.rotation * fromPivot + inverseDistance * (correction.pivot - eye);
}

}  // namespace ibr::reference
