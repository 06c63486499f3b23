#version 460
// SPDX-License-Identifier: Apache-2.0
// Morphs a vertex of a cell for both eyes in one render pass.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_multiview : require
#include "render/cell_vertex.glsl"

layout(constant_id = 8) const uint kViewStride = 1u;  // from an item's parameters in one view to the next view's

layout(location = 0) in vec3 inPoint[kMaxMembers];
layout(location = 4) in float inInverseDistance;

void main() { placeVertex(inPoint, inInverseDistance, gl_InstanceIndex + gl_ViewIndex * kViewStride); }
