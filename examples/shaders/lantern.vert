#version 460
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 inPosition;
layout(location = 1) in vec3 inNormal;
layout(location = 2) in vec3 inColour;
layout(location = 3) in vec3 inEmissive;

layout(push_constant) uniform Constants {
  mat4 toClip;  // from the model's axes
};

layout(location = 0) out vec3 outNormal;
layout(location = 1) out vec3 outColour;
layout(location = 2) out vec3 outEmissive;

void main() {
  outNormal = inNormal;
  outColour = inColour;
  outEmissive = inEmissive;
  gl_Position = toClip * vec4(inPosition, 1.0);
}
