#version 460
// SPDX-License-Identifier: Apache-2.0
// Sorts the members of each vertex into the order of the plan, so that loops visit the best camera first and no
// unplanned one. One thread per vertex.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/htm.h"
#include "htm/htm_blend.glsl"
#include "htm/htm_vertex.glsl"

layout(local_size_x = kHtmGroupSize) in;

layout(set = 0, binding = kBindingHtmMembers, scalar) readonly buffer Members {
  uvec2 members[];
};
layout(set = 0, binding = kBindingHtmCameras, scalar) readonly buffer Cameras {
  HtmCameraParameters cameras[];
};
layout(set = 0, binding = kBindingHtmRanked, scalar) writeonly buffer Ranked {
  uvec2 ranked[];
};
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

void main() {
  const uint v = htmVertex();
  if (v >= frame.vertexCount) return;
  const uvec2 mine = members[v];
  uvec2 inOrder = uvec2(0u);
  for (uint k = 0u; k < frame.plannedCount; ++k) {
    const uint bit = htmHas(mine, cameras[k].camera) ? 1u : 0u;
    inOrder |= k < 32u ? uvec2(bit << k, 0u) : uvec2(0u, bit << (k - 32u));
  }
  ranked[v] = inOrder;
}
