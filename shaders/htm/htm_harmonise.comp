#version 460
// SPDX-License-Identifier: Apache-2.0
// Harmonised texture coordinates ([H] eq. 6). For vertex v and camera i: the mean of the complements v̂^{i←j} − o^i
// over the vertex's cameras j, weighted by eq. 5. A vertex without members is not displaced.
//
// One thread per vertex, one row of groups per planned camera i: neighbouring threads read neighbouring complements.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/htm.h"
#include "htm/htm_blend.glsl"
#include "htm/htm_vertex.glsl"

layout(local_size_x = kHtmGroupSize) in;

layout(set = 0, binding = kBindingHtmRanked, scalar) readonly buffer Ranked {
  uvec2 ranked[];
};
layout(set = 0, binding = kBindingHtmComplements, scalar) readonly buffer Complements {
  vec2 complements[];
};
layout(set = 0, binding = kBindingHtmCameras, scalar) readonly buffer Cameras {
  HtmCameraParameters cameras[];
};
layout(set = 0, binding = kBindingHtmDisplacements, scalar) writeonly buffer Displacements {
  vec2 displacements[];
};
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

void main() {
  const uint v = htmVertex(), i = gl_WorkGroupID.y;
  if (v >= frame.vertexCount) return;
  uvec2 left = ranked[v];
  const uint first = cameras[i].camera * frame.cameraCount * frame.vertexCount + v;
  HtmBlend mean = htmNothing();
  bool settled = false;
  for (; htmAny(left) && !settled; left = htmWithoutFirst(left)) {
    const uint j = htmFirst(left);
    htmAdd(mean, cameras[j].log2Weight, 1.0, vec3(complements[first + cameras[j].camera * frame.vertexCount], 0.0));
    settled = htmSettled(mean, cameras[j].log2Rest, frame.cut);
  }
  displacements[i * frame.vertexCount + v] = mean.sum.w > 0.0 ? mean.sum.xy / mean.sum.w : vec2(0.0);
}
