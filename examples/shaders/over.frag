#version 460
// SPDX-License-Identifier: Apache-2.0
// Puts a picture over the image wherever its alpha is not 0.
layout(set = 0, binding = 0) uniform sampler2D picture[1];

layout(location = 0) out vec4 outColour;

void main() {
  const vec4 colour = texelFetch(picture[0], ivec2(gl_FragCoord.xy), 0);
  if (colour.a == 0.0) discard;
  outColour = vec4(colour.rgb, 1.0);
}
