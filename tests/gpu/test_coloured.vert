// SPDX-License-Identifier: Apache-2.0
#version 460
layout(location = 0) in vec3 position;  // clip space
layout(location = 1) in vec3 colour;
layout(location = 0) out vec3 outColour;

void main() {
  gl_Position = vec4(position, 1.0);
  outColour = colour;
}
