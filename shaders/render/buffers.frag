#version 460
// SPDX-License-Identifier: Apache-2.0
// Writes a cell pixel's depth, weights and confidence: BufferTargets in ibr/target.h.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"

layout(location = 6) in float inInverseDistance;  // ρ
layout(location = 7) in float inUncertainty;

layout(push_constant) uniform Constants {
  float rank;
  float extrapolation;
};

layout(location = 0) out vec4 outSurface;  // depth, tier, rank, extrapolation distance
layout(location = 1) out vec4 outWeights;
layout(location = 2) out vec2 outConfidence;  // spread, uncertainty

void main() {
  Sampling samplings[kMaxMembers];
  for (int i = 0; i < kMembers; ++i) samplings[i] = sampling(i, inDetail);
  if (kDissolve && isDissolved(uvec2(gl_FragCoord.xy))) discard;
  vec3 colours[kMaxMembers];
  vec4 weights = vec4(0.0);
  vec3 mean = vec3(0.0);
  for (int i = 0; i < kMembers; ++i) weights[i] = cells[inCell].member[i].blend;
  if (kMasked) {
    const Shown shown = shownMembers(samplings, weights);
    weights = shown.weights;
    colours = shown.colour;
    if (weights == vec4(0.0)) discard;
    for (int i = 0; i < kMembers; ++i) mean += weights[i] * colours[i];
  } else {
    for (int i = 0; i < kMembers; ++i) {
      colours[i] = vec3(0.0);
      if (weights[i] <= 0.0) continue;
      const float last = ceil(samplings[i].reach);
      for (float k = -last; k <= last; ++k) colours[i] += tap(i, i, samplings[i], k).rgb;
      mean += weights[i] * colours[i];
    }
  }
  float variance = 0.0;
  for (int i = 0; i < kMembers; ++i)
    if (weights[i] > 0.0) variance += weights[i] * dot(colours[i] - mean, colours[i] - mean) / 3.0;
  // ρ and clip space have the same scale per vertex, so ρ / w is the inverse depth.
  const float inverseDepth = inInverseDistance * gl_FragCoord.w;
  outSurface = vec4(1.0 / max(inverseDepth, 0.0), 0.0, rank, extrapolation);
  outWeights = weights;
  outConfidence = vec2(sqrt(variance), inUncertainty);
}
