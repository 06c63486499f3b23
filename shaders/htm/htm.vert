#version 460
// SPDX-License-Identifier: Apache-2.0
// Passes position, barycentric shares and triangle to htm.frag.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "htm/htm_corner.glsl"

layout(location = 0) out vec3 outPosition;
layout(location = 1) out vec2 outShare;  // shares of the second and third corner
layout(location = 2) flat out uint outTriangle;

void main() {
  const int corner = gl_VertexIndex % 3;
  outPosition = positions[triangles[gl_VertexIndex]];
  outShare = vec2(corner == 1, corner == 2);
  outTriangle = uint(gl_VertexIndex / 3);
  gl_Position = frame.clip * vec4(outPosition, 1.0);
}
