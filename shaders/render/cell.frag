#version 460
// SPDX-License-Identifier: Apache-2.0
// Colours of a cell's members at a fragment, blended ([T] eq. 6), dithered (eq. 7), or the mean of both.
//
// Texture coordinates come from interpolated values alone: a buffer read gives 0 in the helper pixels of some devices
// (lavapipe), and gradients would be wrong along every edge.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/cell.h"

layout(constant_id = 0) const int kMembers = 4;
layout(constant_id = 1) const bool kOnePage = false;   // all members' photographs are layers of one image
layout(constant_id = 2) const bool kDissolve = false;  // opacity below 1: pixels are left to what lies behind

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

float noise(uvec2 offset) {
  const uvec2 pixel = (uvec2(gl_FragCoord.xy) + offset) % uint(kNoiseSize);
  return noiseFromRank(noiseRank[pixel.y * uint(kNoiseSize) + pixel.x]);
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
  if (kDissolve && noise(kDissolveOffset) >= cells[inCell].opacity) discard;
  const uint blending = cells[inCell].blending;
  vec3 blended = vec3(0.0), dithered = vec3(0.0);
  if (blending != kDither)
    for (int i = 0; i < kMembers; ++i)
      if (weights[i] > 0.0) blended += weights[i] * photograph(i, at[i], dx[i], dy[i]);
  if (blending != kBlend) {
    const int chosen = ditherMember(weights, noise(uvec2(0)));
    if (kOnePage) {
      const vec3 coordinate = vec3(at[chosen], float(cells[inCell].member[chosen].layer));
      dithered = textureGrad(photograph0, coordinate, dx[chosen], dy[chosen]).rgb;
    } else {
      for (int i = 0; i < kMembers; ++i)
        if (i == chosen) dithered = photograph(i, at[i], dx[i], dy[i]);
    }
  }
  const vec3 colour = blending == kBlend ? blended : (blending == kDither ? dithered : 0.5 * (blended + dithered));
  outColour = vec4(colour, cells[inCell].alpha);
}
