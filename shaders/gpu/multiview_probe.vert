#version 460
// SPDX-License-Identifier: Apache-2.0
// A small square in the corner of a view that gl_InstanceIndex names, in a colour of view and square; 4 is a triangle
// behind them all that is larger than the view and must be clipped.
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
