#version 460
// SPDX-License-Identifier: Apache-2.0
// Morphs a vertex of a cell, and passes ρ and its uncertainty to buffers.frag.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_vertex.glsl"

layout(location = 0) in vec3 inPoint[kMaxMembers];
layout(location = 4) in float inInverseDistance;
layout(location = 5) in float inUncertainty;  // of ρ

layout(location = 6) out float outInverseDistance;
layout(location = 7) out float outUncertainty;

void main() {
  outInverseDistance = placeVertex(inPoint, inInverseDistance, gl_InstanceIndex);
  outUncertainty = inUncertainty;
}
