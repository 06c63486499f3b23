#version 460
// SPDX-License-Identifier: Apache-2.0
// Position of a corner of the mesh in the camera's image, without further outputs.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "htm/htm_corner.glsl"

void main() {
  gl_Position = frame.clip * vec4(positions[triangles[gl_VertexIndex]], 1.0);
}
