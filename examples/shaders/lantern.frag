#version 460
// SPDX-License-Identifier: Apache-2.0
// Lighting by a sun, a sky above and the ground below. Colours are linear.
layout(location = 0) in vec3 inNormal;
layout(location = 1) in vec3 inColour;
layout(location = 2) in vec3 inEmissive;

layout(location = 0) out vec4 outColour;

const vec3 kToSun = vec3(0.48, 0.64, 0.6);

void main() {
  const vec3 normal = normalize(inNormal);
  const float light = 0.35 + 0.25 * normal.y + 0.9 * max(dot(normal, kToSun), 0.0);
  outColour = vec4(pow(min(inColour * light + inEmissive, 1.0), vec3(1.0 / 2.2)), 1.0);
}
