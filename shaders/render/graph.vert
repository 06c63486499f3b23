#version 460
// SPDX-License-Identifier: Apache-2.0
// Expands a line of the image graph to a strip of constant width in pixels: one instance, two triangles, per line.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/graph.h"

layout(location = 0) in vec3 inFrom;
layout(location = 1) in vec3 inTo;
layout(push_constant, scalar) uniform Constants { GraphConstants constants; };

layout(location = 0) out float outAcross;  // px from the line's middle
layout(location = 1) out float outFade;

vec2 pixelOf(vec3 point) {
  return constants.lens.zw + constants.lens.xy * vec2(point.x, -point.y) / -point.z;
}

void main() {
  const float near = 1e-3 * constants.fade;
  vec3 ends[2] = {constants.toView * (inFrom + constants.shift), constants.toView * (inTo + constants.shift)};
  const vec2 depth = vec2(-ends[0].z, -ends[1].z);
  gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // degenerate and outside the image
  outAcross = outFade = 0.0;
  if (max(depth.x, depth.y) <= near) return;
  const vec3 along = ends[1] - ends[0];
  if (depth.x < near) ends[0] += along * ((near - depth.x) / (depth.y - depth.x));
  if (depth.y < near) ends[1] -= along * ((near - depth.y) / (depth.x - depth.y));

  const int corner = int[](0, 1, 2, 2, 1, 3)[gl_VertexIndex];
  const vec2 from = pixelOf(ends[0]), to = pixelOf(ends[1]);
  const float pixels = distance(from, to);
  const vec2 direction = pixels > 1e-6 ? (to - from) / pixels : vec2(1.0, 0.0);
  const float reach = constants.halfWidth + 0.5;
  outAcross = (corner & 1) == 0 ? -reach : reach;
  const vec2 at = (corner < 2 ? from : to) + outAcross * vec2(-direction.y, direction.x);
  outFade = smoothstep(0.0, constants.fade, -ends[corner < 2 ? 0 : 1].z);
  gl_Position = vec4(2.0 * at / constants.size - 1.0, 0.0, 1.0);
}
