#version 460
// SPDX-License-Identifier: Apache-2.0
// A sky, and a grid on the ground, for a level camera.
layout(location = 0) in vec2 inScreen;

layout(push_constant) uniform Constants {
  vec2 tangents;  // of half the fields of view
};

layout(location = 0) out vec4 outColour;

const float kEyeHeight = 5.0;  // world units

void main() {
  const vec3 direction = vec3(inScreen.x * tangents.x, -inScreen.y * tangents.y, -1.0);
  if (direction.y >= 0.0) {
    outColour = vec4(mix(vec3(0.75, 0.85, 0.95), vec3(0.25, 0.5, 0.85), direction.y / tangents.y), 1.0);
    return;
  }
  const vec2 ground = direction.xz * (kEyeHeight / -direction.y);
  const vec2 toLine = abs(fract(ground) - 0.5) / fwidth(ground);  // px
  const float line = 1.0 - clamp(min(toLine.x, toLine.y), 0.0, 1.0);
  outColour = vec4(mix(vec3(0.25, 0.3, 0.35), vec3(0.8), line), 1.0);
}
