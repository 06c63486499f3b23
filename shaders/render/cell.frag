#version 460
// SPDX-License-Identifier: Apache-2.0
// Colours of a cell's members at a fragment, blended ([T] eq. 6) or dithered (eq. 7).
//
// Texture coordinates come from interpolated values alone: a buffer read gives 0 in the helper pixels of some devices
// (lavapipe), and gradients would be wrong along every edge.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/cell.h"

layout(constant_id = 0) const int kMembers = 4;

layout(location = 0) in vec3 inTexture[kMaxMembers];
layout(location = 4) flat in uint inCell;

layout(set = kSetFrame, binding = kBindingParameters, scalar) readonly buffer Parameters { CellParameters cells[]; };
layout(set = kSetFrame, binding = kBindingNoise, scalar) readonly buffer Noise { uint noiseRank[]; };
layout(set = kSetCell, binding = 0) uniform sampler2DArray photograph0;
layout(set = kSetCell, binding = 1) uniform sampler2DArray photograph1;
layout(set = kSetCell, binding = 2) uniform sampler2DArray photograph2;
layout(set = kSetCell, binding = 3) uniform sampler2DArray photograph3;

layout(location = 0) out vec4 outColour;

// Gradients come from outside: implicit ones would measure the parallax between members wherever the choice of a member
// changes from one pixel to the next. Samplers are not indexed, since not every device can.
vec3 photograph(int member, vec2 at, vec2 dx, vec2 dy) {
  const vec3 coordinate = vec3(at, float(cells[inCell].member[member].layer));
  if (member == 0) return textureGrad(photograph0, coordinate, dx, dy).rgb;
  if (member == 1) return textureGrad(photograph1, coordinate, dx, dy).rgb;
  if (member == 2) return textureGrad(photograph2, coordinate, dx, dy).rgb;
  return textureGrad(photograph3, coordinate, dx, dy).rgb;
}

void main() {
  vec2 at[kMaxMembers], dx[kMaxMembers], dy[kMaxMembers];
  vec4 weights = vec4(0.0);
  for (int i = 0; i < kMembers; ++i) {
    at[i] = inTexture[i].xy / inTexture[i].z;
    dx[i] = dFdx(at[i]);
    dy[i] = dFdy(at[i]);
    weights[i] = cells[inCell].member[i].blend;
  }
  vec3 colour = vec3(0.0);
  if (cells[inCell].dither != 0) {
    const uvec2 pixel = uvec2(gl_FragCoord.xy) % uint(kNoiseSize);
    const int chosen = ditherMember(weights, noiseFromRank(noiseRank[pixel.y * uint(kNoiseSize) + pixel.x]));
    for (int i = 0; i < kMembers; ++i)
      if (i == chosen) colour = photograph(i, at[i], dx[i], dy[i]);
  } else {
    for (int i = 0; i < kMembers; ++i)
      if (weights[i] > 0.0) colour += weights[i] * photograph(i, at[i], dx[i], dy[i]);
  }
  outColour = vec4(colour, cells[inCell].alpha);
}
