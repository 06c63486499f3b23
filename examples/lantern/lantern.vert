#version 460
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 inPosition;
layout(location = 1) in vec3 inNormal;

layout(push_constant) uniform Constants {
  mat4 toClip;     // of the model
  vec3 baseColour;  // linear, as in glTF
  float unused;
  vec3 emissive;
};

layout(location = 0) out vec3 outNormal;

void main() {
  outNormal = inNormal;
  gl_Position = toClip * vec4(inPosition, 1.0);
}
