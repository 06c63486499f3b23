#version 460
// SPDX-License-Identifier: Apache-2.0
// Votes for a pixel's surfaces: selects the hypotheses that show most, nearest first.
//   target: ρ of the first surface, of the second (−1: there is none), opacity of the first, gatherCode
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather_view.glsl"

layout(local_size_x = kGatherGroup, local_size_y = kGatherGroup) in;
layout(constant_id = 0) const int kCandidates = 12;
layout(constant_id = 1) const int kLayers = 2;
layout(set = kSetGatherView, binding = kBindingGatherAtlas) uniform usampler2D atlas;
layout(set = kSetGatherView, binding = kBindingGatherVote, rgba32f) uniform writeonly image2D target;

float rho[kCandidates], weight[kCandidates], consensus[kCandidates], trust[kCandidates], support[kCandidates];
float presence[kCandidates];  // 0: not a surface of its own

struct Shown {
  int who;      // index of a hypothesis; −1: none
  float share;  // of the pixel
};

void readHypotheses(uvec2 pixel) {
  for (int i = 0; i < kCandidates; ++i) {
    const uvec2 tile = c.tile * uvec2(i % kGatherColumns, i / kGatherColumns);
    // Tiles beyond the candidates are not drawn, and may contain NaN.
    const uvec2 hypothesis = i < int(views[c.view].count) ? texelFetch(atlas, ivec2(tile + pixel), 0).rg : uvec2(0u);
    const vec2 evidence = unpackHalf2x16(hypothesis.y);
    rho[i] = uintBitsToFloat(hypothesis.x);
    trust[i] = evidence.x;
    consensus[i] = evidence.y;
    weight[i] = evidence.x * views[c.view].candidate[i].voteWeight;
  }
}

void findPresences(float step) {
  float most = 0.0;
  for (int i = 0; i < kCandidates; ++i) {
    support[i] = 0.0;
    if (weight[i] > 0.0)
      for (int j = 0; j < kCandidates; ++j) support[i] += weight[j] * gatherKernel(rho[i], rho[j], step);
    most = max(most, support[i]);
  }
  for (int i = 0; i < kCandidates; ++i) {
    presence[i] = weight[i] > 0.0 ? support[i] / most : 0.0;
    if (presence[i] > 0.0)
      for (int j = 0; j < kCandidates; ++j)
        if (weight[j] > 0.0 && (support[j] > support[i] || (support[j] == support[i] && j < i)))
          presence[i] *= max(1.0 - gatherKernel(rho[i], rho[j], step) / kGatherSameSurface, 0.0);
  }
}

// Returns means over the hypotheses around one: ρ, consensus, share of completed depth.
vec3 surfaceAt(int peak, float step) {
  float sum = 0.0;
  vec3 mean = vec3(0.0);
  for (int j = 0; j < kCandidates; ++j) {
    const float w = weight[j] * gatherKernel(rho[peak], rho[j], step);
    sum += w;
    mean += w * vec3(rho[j], consensus[j], trust[j] < kGatherCompleted ? 1.0 : 0.0);
  }
  return mean / sum;
}

// Composites from front to back. The last surface has nothing behind it, so it counts as opaque.
Shown[2] maxShown(float step) {
  Shown most[2] = Shown[2](Shown(-1, 0.0), Shown(-1, 0.0));
  uint left = 0u;
  for (int i = 0; i < kCandidates; ++i)
    if (presence[i] > 0.0) left |= 1u << i;
  float through = 1.0;
  while (left != 0u) {
    int nearest = -1;
    for (int i = 0; i < kCandidates; ++i)
      if ((left >> i & 1u) != 0u && (nearest < 0 || rho[i] > rho[nearest])) nearest = i;
    left &= ~(1u << nearest);
    float nothingBehind = 1.0;
    for (int i = 0; i < kCandidates; ++i)
      if ((left >> i & 1u) != 0u) nothingBehind *= 1.0 - presence[i];
    const float opacity = clamp(surfaceAt(nearest, step).y / kGatherFullConsensus, 0.0, 1.0);
    const Shown next = Shown(nearest, through * presence[nearest] * mix(opacity, 1.0, nothingBehind));
    through -= next.share;
    if (next.share > most[0].share) {
      most[1] = most[0];
      most[0] = next;
    } else if (next.share > most[1].share) {
      most[1] = next;
    }
  }
  return most;
}

// Root mean square of all hypotheses' distance from a surface, as a share of its ρ.
float spreadAbout(float surface) {
  float sum = 0.0, square = 0.0;
  int count = 0;
  for (int j = 0; j < kCandidates; ++j) {
    const float off = min(abs(rho[j] - surface) / max(surface, kGatherMinApart), 1.0);
    sum += weight[j];
    square += weight[j] * off * off;
    count += weight[j] > 0.0 ? 1 : 0;
  }
  return count == 1 ? kGatherAloneSpread : sqrt(square / sum);
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= c.voteExtent.x || pixel.y >= c.voteExtent.y) return;
  const float step = views[c.view].step;
  readHypotheses(pixel);
  findPresences(step);
  Shown shown[2] = maxShown(step);
  if (kLayers == 1) shown[1].who = -1;
  if (shown[1].who >= 0 && rho[shown[1].who] > rho[shown[0].who])
    shown = Shown[2](shown[1], shown[0]);
  vec4 result = vec4(0.0, -1.0, 1.0, 0.0);
  if (shown[0].who >= 0) {
    const vec3 first = surfaceAt(shown[0].who, step);
    vec3 second = vec3(0.0);
    result.x = first.x;
    if (shown[1].who >= 0) {
      second = surfaceAt(shown[1].who, step);
      result.y = second.x;
      result.z = shown[0].share / (shown[0].share + shown[1].share);
    }
    const float opaque = shown[1].who >= 0 && result.z < 0.5 ? result.y : result.x;
    result.w = gatherCode(first.z > 0.5, first.y, second.z > 0.5, second.y, spreadAbout(opaque));
  }
  imageStore(target, ivec2(pixel), result);
}
