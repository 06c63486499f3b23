#version 460
// SPDX-License-Identifier: Apache-2.0
// The surfaces of a pixel: peaks of support among the candidates' hypotheses, nearest first.
//   target: ρ of the first surface, of the second (−1: there is none), opacity of the first,
//           1 + (first completed) + 2 · (second completed), or 0 where there is no hypothesis
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather_view.glsl"

layout(local_size_x = kGatherGroup, local_size_y = kGatherGroup) in;
layout(constant_id = 0) const int kCandidates = 12;
layout(constant_id = 1) const int kLayers = 2;
layout(set = kSetGatherView, binding = kBindingGatherAtlas) uniform usampler2D atlas;
layout(set = kSetGatherView, binding = kBindingGatherVote, rgba32f) uniform writeonly image2D target;

float rho[kCandidates], weight[kCandidates], consensus[kCandidates], trust[kCandidates], support[kCandidates];

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= c.voteExtent.x || pixel.y >= c.voteExtent.y) return;
  const float step = views[c.view].step;
  for (int i = 0; i < kCandidates; ++i) {
    const uvec2 tile = c.tile * uvec2(i % kGatherColumns, i / kGatherColumns);
    // Tiles beyond the candidates were not drawn: what lies there may be no number.
    const uvec2 hypothesis = i < int(views[c.view].count) ? texelFetch(atlas, ivec2(tile + pixel), 0).rg : uvec2(0u);
    const vec2 evidence = unpackHalf2x16(hypothesis.y);
    rho[i] = uintBitsToFloat(hypothesis.x);
    trust[i] = evidence.x;
    consensus[i] = evidence.y;
    weight[i] = evidence.x * views[c.view].candidate[i].voteWeight;
  }
  float most = 0.0;
  for (int i = 0; i < kCandidates; ++i) {
    support[i] = 0.0;
    if (weight[i] > 0.0)
      for (int j = 0; j < kCandidates; ++j) support[i] += weight[j] * gatherKernel(rho[i], rho[j], step);
    most = max(most, support[i]);
  }
  uint peaks = 0u;
  for (int i = 0; i < kCandidates; ++i) {
    bool peak = weight[i] > 0.0 && support[i] > kGatherSupportShare * most;
    for (int j = 0; j < kCandidates; ++j)
      if (weight[j] > 0.0 && gatherKernel(rho[i], rho[j], step) > 0.0 &&
          (support[j] > support[i] || (support[j] == support[i] && j < i)))
        peak = false;
    if (peak) peaks |= 1u << i;
  }
  vec4 result = vec4(0.0, -1.0, 1.0, 0.0);
  for (int l = 0; l < kLayers; ++l) {
    int nearest = -1;
    for (int i = 0; i < kCandidates; ++i)
      if ((peaks >> i & 1u) != 0u && (nearest < 0 || rho[i] > rho[nearest])) nearest = i;
    if (nearest < 0) break;
    peaks &= ~(1u << nearest);
    float sum = 0.0, depth = 0.0, agreed = 0.0, completed = 0.0;
    for (int j = 0; j < kCandidates; ++j) {
      const float w = weight[j] * gatherKernel(rho[nearest], rho[j], step);
      sum += w;
      depth += w * rho[j];
      agreed += w * consensus[j];
      completed += trust[j] < kGatherCompleted ? w : 0.0;
    }
    const bool isCompleted = completed > 0.5 * sum;
    if (l == 0) {
      result.x = depth / sum;
      result.z = clamp(agreed / sum / kGatherFullConsensus, 0.0, 1.0);
      result.w = isCompleted ? 2.0 : 1.0;
    } else {
      result.y = depth / sum;
      result.w += isCompleted ? 2.0 : 0.0;
    }
  }
  imageStore(target, ivec2(pixel), result);
}
