#version 460
// SPDX-License-Identifier: Apache-2.0
// Fills one finer level in place (push, shared/fill.h). Reads only texels in use; the images may be larger.
#extension GL_GOOGLE_include_directive : require
#include "shared/fill.h"

layout(local_size_x = kFillGroup, local_size_y = kFillGroup) in;
layout(set = 0, binding = 0) uniform sampler2D coarser;
layout(set = 0, binding = 1, rgba16f) uniform image2D finer;
layout(push_constant) uniform Constants {
  ivec2 fine;
  ivec2 coarse;
};

vec3 coarseTexel(ivec2 at) { return texelFetch(coarser, clamp(at, ivec2(0), coarse - 1), 0).rgb; }

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= fine.x || pixel.y >= fine.y) return;
  const vec4 value = imageLoad(finer, pixel);
  if (value.a >= 1.0) return;
  const vec2 at = 0.5 * (vec2(pixel) + 0.5) - 0.5;
  const ivec2 corner = ivec2(floor(at));
  const vec2 t = at - vec2(corner);
  const vec3 above = mix(coarseTexel(corner), coarseTexel(corner + ivec2(1, 0)), t.x);
  const vec3 below = mix(coarseTexel(corner + ivec2(0, 1)), coarseTexel(corner + ivec2(1, 1)), t.x);
  const float any = texelFetch(coarser, ivec2(0), 0).a > 0.0 ? 1.0 : 0.0;  // 0: the whole image is empty
  imageStore(finer, pixel, vec4(mix(mix(above, below, t.y), value.rgb, value.a), any));
}
