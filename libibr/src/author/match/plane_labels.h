// SPDX-License-Identifier: Apache-2.0
// Sets of planes as labels of vertices (MorphMesh::planes).
//
// A vertex where planes meet lies on all of them. A triangle whose vertices share a plane is homogeneous: one
// homography explains it. In any other there is parallax or distortion.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/scene.h"

namespace ibr {

/// The first plane that three sets have in common, counted from 1; 0 where they have none.
std::uint16_t commonPlane(const glm::u16vec4& a, const glm::u16vec4& b, const glm::u16vec4& c);

/// Whether each triangle is homogeneous; with no labels none is known to be otherwise, and all are.
inline bool homogeneous(std::span<const glm::u16vec4> planes, const glm::uvec3& t) {
  return planes.empty() || commonPlane(planes[t.x], planes[t.y], planes[t.z]) != 0;
}

/// Share of the triangles of tier 0 that are; NaN without labels or without triangles.
double homogeneousShare(const MorphMesh& mesh);

}  // namespace ibr
