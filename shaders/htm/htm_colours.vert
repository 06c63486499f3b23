#version 460
// SPDX-License-Identifier: Apache-2.0
// Passes a vertex's colour to htm_colours.frag.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "htm/htm_corner.glsl"

layout(set = 0, binding = kBindingHtmColours, scalar) readonly buffer Colours {
  vec4 colours[];
};

layout(location = 0) out vec4 outColour;

void main() {
  const uint vertex = triangles[gl_VertexIndex];
  outColour = colours[vertex];
  gl_Position = frame.clip * vec4(positions[vertex], 1.0);
}
