#version 460
// SPDX-License-Identifier: Apache-2.0
// Morphs a vertex of a candidate's mesh with one member (cell_vertex.glsl). The instance is the candidate.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather_view.glsl"

layout(location = 0) in vec3 inPoint;             // q, photograph axes
layout(location = 1) in float inInverseDistance;  // ρ, 1 / world unit
layout(location = 2) in vec2 inEvidence;          // trust, consensus

layout(location = 0) out vec3 outHypothesis;  // ρ before the division by depth, trust, consensus

void main() {
  const float rho = inInverseDistance * views[c.view].spacing;
  const vec3 direction = views[c.view].candidate[gl_InstanceIndex].toView * inPoint +
                         rho * views[c.view].candidate[gl_InstanceIndex].place;
  const vec4 projection = views[c.view].projection;
  gl_Position = vec4(projection.x * direction.x - projection.y * direction.z,
                     projection.z * direction.y - projection.w * direction.z, -direction.z - kGatherNear * rho,
                     -direction.z);
  outHypothesis = vec3(rho, inEvidence);
}
