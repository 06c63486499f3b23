#version 460
// SPDX-License-Identifier: Apache-2.0
// Computes one coarser level (pull, shared/fill.h). The finest source is the canvas, whose alpha is a tier code, 0
// where empty. Hidden pixels count as empty.
#extension GL_GOOGLE_include_directive : require
#include "shared/fill.h"
#include "shared/hidden_area.h"

layout(local_size_x = kFillGroup, local_size_y = kFillGroup) in;
layout(constant_id = 0) const bool kFromCanvas = false;
layout(set = 0, binding = 0) uniform sampler2D source;
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2D target;
layout(push_constant) uniform Constants {
  ivec2 fine;    // extents in use
  ivec2 coarse;
};

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= coarse.x || pixel.y >= coarse.y) return;
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const ivec2 at = 2 * pixel + ivec2(i, j);
      if (at.x >= fine.x || at.y >= fine.y) continue;
      const vec4 value = texelFetch(source, at, 0);
      const float w = kFromCanvas ? (isDrawn(value.a) ? 1.0 : 0.0) : value.a;
      sum += w * value.rgb;
      weight += w;
    }
  imageStore(target, pixel, vec4(weight > 0.0 ? sum / weight : vec3(0.0), pulledWeight(weight)));
}
