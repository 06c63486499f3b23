#version 460
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) out vec4 outColour;

void main() {
  outColour = vec4(0.1, 0.35, 0.6, 0.6);
}
