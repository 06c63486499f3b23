#version 460
// SPDX-License-Identifier: Apache-2.0
// Morphs a vertex of a cell.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_vertex.glsl"

layout(location = 0) in vec3 inPoint[kMaxMembers];  // q_i; locations 0 to 3, those beyond kMembers repeat the last
layout(location = 4) in float inInverseDistance;    // ρ

void main() { placeVertex(inPoint, inInverseDistance, gl_InstanceIndex); }
