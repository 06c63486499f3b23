#version 460
// SPDX-License-Identifier: Apache-2.0
layout(constant_id = 0) const bool kLinear = false;  // true: an sRGB target, which encodes the output

layout(location = 0) in vec4 inColour;
layout(location = 0) out vec4 outColour;

vec3 linearOf(vec3 encoded) {
  return mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)), greaterThan(encoded, vec3(0.04045)));
}

void main() {
  outColour = vec4(kLinear ? linearOf(inColour.rgb) : inColour.rgb, inColour.a);
}
