#version 460
// SPDX-License-Identifier: Apache-2.0
// View-dependent vertex colours (VDVBM, what [H] §4.2 compares with): the mean over a vertex's cameras of the pixel
// where it is projected, weighted by eq. 5. A thread a vertex.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/htm.h"
#include "htm/htm_blend.glsl"

layout(local_size_x = kHtmGroupSize) in;

layout(set = 0, binding = kBindingHtmPositions, scalar) readonly buffer Positions {
  vec3 positions[];
};
layout(set = 0, binding = kBindingHtmRanked, scalar) readonly buffer Ranked {
  uvec2 ranked[];
};
layout(set = 0, binding = kBindingHtmCameras, scalar) readonly buffer Cameras {
  HtmCameraParameters cameras[];
};
layout(set = 0, binding = kBindingHtmColours, scalar) writeonly buffer Colours {
  vec4 colours[];
};
layout(set = 0, binding = kBindingHtmPhotographs) uniform sampler2DArray photographs;
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

void main() {
  const uint v = gl_GlobalInvocationID.x;
  if (v >= frame.vertexCount) return;
  uvec2 left = ranked[v];
  const vec4 position = vec4(positions[v], 1.0);
  const vec2 texel = 1.0 / vec2(textureSize(photographs, 0).xy);
  HtmBlend mean = htmNothing();
  bool settled = false;
  for (; htmAny(left) && !settled; left = htmWithoutFirst(left)) {
    const uint k = htmFirst(left);
    const uint camera = cameras[k].camera;
    const float depth = dot(cameras[k].depthOf, position);
    const float inFront = max(depth, 0.5 * cameras[k].nearDistance);
    const vec2 at = vec2(dot(cameras[k].column, position), dot(cameras[k].row, position)) / inFront;
    const vec2 border = 2.0 * min(at, cameras[k].size - at);
    const float inside = depth == inFront ? clamp(min(border.x, border.y), 0.0, 1.0) : 0.0;
    const vec3 read = textureLod(photographs, vec3(at * texel, camera), 0.0).rgb;
    htmAdd(mean, cameras[k].log2Weight, inside, read);
    settled = htmSettled(mean, cameras[k].log2Rest, frame.cut);
  }
  colours[v] = mean.sum.w > 0.0 ? vec4(mean.sum.rgb / mean.sum.w, 1.0) : vec4(0.0);
}
