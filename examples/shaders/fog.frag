#version 460
// SPDX-License-Identifier: Apache-2.0
// Fog that thickens with the depth of a rendered picture.
layout(set = 0, binding = 0) uniform sampler2D rendered[2];  // colour; BufferTargets::surface of ibr/target.h

layout(push_constant) uniform Constants {
  vec4 fogColour;
  float range;  // depth at which 63 % of the light is fog, world units
};

layout(location = 0) out vec4 outColour;

void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  const vec3 colour = texelFetch(rendered[0], pixel, 0).rgb;
  const float depth = texelFetch(rendered[1], pixel, 0).r;  // infinity: nothing is drawn, or infinitely far
  const float fog = 1.0 - exp(-min(depth / range, 50.0));
  outColour = vec4(mix(colour, fogColour.rgb, fog), 1.0);
}
