#version 460
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 inPosition;
layout(location = 1) in vec4 inColour;  // display-encoded, straight alpha

layout(push_constant) uniform Constants {
  mat4 toClip;
  float strength;  // factor on all alphas
};

layout(location = 0) out vec4 outColour;

void main() {
  outColour = vec4(inColour.rgb, inColour.a * strength);
  gl_Position = toClip * vec4(inPosition, 1.0);
}
