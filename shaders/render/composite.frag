#version 460
// SPDX-License-Identifier: Apache-2.0
// Canvas → target: background where nothing was drawn, and the transfer function that the target's format undoes.
layout(constant_id = 0) const bool kEncodedByTarget = false;  // an SRGB format

layout(set = 0, binding = 0) uniform sampler2D canvas;
layout(set = 0, binding = 1) uniform sampler2D formerCanvas;  // the picture of the order before a switch
layout(push_constant) uniform Constants {
  vec3 background;     // display-encoded
  uint keepTier;       // 1: alpha is the canvas's tier code, 0: alpha is 1
  float formerWeight;  // 0: the former canvas is not read
};

layout(location = 0) out vec4 outColour;

vec3 decode(vec3 encoded) {  // IEC 61966-2-1
  return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}

void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  const vec4 drawn = texelFetch(canvas, pixel, 0);
  vec3 colour = drawn.a > 0.0 ? drawn.rgb : background;
  if (formerWeight > 0.0) {
    const vec4 former = texelFetch(formerCanvas, pixel, 0);
    colour = mix(colour, former.a > 0.0 ? former.rgb : background, formerWeight);
  }
  outColour = vec4(kEncodedByTarget ? decode(colour) : colour, keepTier != 0 ? drawn.a : 1.0);
}
