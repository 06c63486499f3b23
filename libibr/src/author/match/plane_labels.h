// SPDX-License-Identifier: Apache-2.0
// Sets of planes as labels of vertices (MorphMesh::planes).
//
// A vertex where planes meet lies on all of them. A triangle whose vertices share a plane is homogeneous: one
// homography explains the triangle. Any other triangle has parallax or distortion.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/scene.h"

namespace ibr {

/// Returns the first plane that three sets share, counted from 1; 0 if there is none.
std::uint16_t commonPlane(const glm::u16vec4& a, const glm::u16vec4& b, const glm::u16vec4& c);

/// True if the triangle is homogeneous. Without labels all triangles count as homogeneous.
inline bool homogeneous(std::span<const glm::u16vec4> planes, const glm::uvec3& t) {
  return planes.empty() || commonPlane(planes[t.x], planes[t.y], planes[t.z]) != 0;
}

/// Share of homogeneous triangles in tier 0; NaN without labels or without triangles.
double homogeneousShare(const MorphMesh& mesh);

}  // namespace ibr
