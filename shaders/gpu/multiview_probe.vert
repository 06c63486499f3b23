#version 460
// SPDX-License-Identifier: Apache-2.0
// Draws a small square in a corner of a view; gl_InstanceIndex selects the corner, view and square give the colour.
// Instance 4 is a triangle behind all squares, larger than the view, which must be clipped.
#extension GL_EXT_multiview : require

layout(location = 0) flat out vec2 outColour;

void main() {
  const vec2 corner = vec2(gl_VertexIndex == 1 || gl_VertexIndex >= 4 ? 1.0 : 0.0,
                           gl_VertexIndex == 2 || gl_VertexIndex == 3 || gl_VertexIndex == 5 ? 1.0 : 0.0);
  const vec2 square = vec2(gl_InstanceIndex & 1, gl_InstanceIndex >> 1);
  gl_Position = vec4(0.5 * (2.0 * square - 2.0 + corner + float(gl_ViewIndex)), 0.5, 1.0);
  if (gl_InstanceIndex == 4)
    gl_Position = vec4(gl_VertexIndex == 1 ? 5.0 : -1.0, gl_VertexIndex == 2 ? 5.0 : -1.0, 0.75, 1.0);
  outColour = vec2(float(gl_ViewIndex + 1), float(gl_InstanceIndex + 1)) / 255.0;
}
