#version 460
// SPDX-License-Identifier: Apache-2.0
// A horizontal square of two triangles, in front of a camera.
layout(push_constant) uniform Constants {
  mat4 toClip;   // from the camera's axes
  float height;  // above the camera, world units
};

const vec2 kCorners[6] = vec2[](vec2(-40, -2), vec2(40, -2), vec2(40, -82), vec2(-40, -2), vec2(40, -82), vec2(-40, -82));

void main() {
  const vec2 corner = kCorners[gl_VertexIndex];
  gl_Position = toClip * vec4(corner.x, height, corner.y, 1.0);
}
