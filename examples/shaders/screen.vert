#version 460
// SPDX-License-Identifier: Apache-2.0
// One triangle that covers the image, nearer than everything.
layout(location = 0) out vec2 outScreen;  // −1 to 1; x right, y down

void main() {
  outScreen = vec2(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0);
  gl_Position = vec4(outScreen, 0.0, 1.0);
}
