#version 460
// SPDX-License-Identifier: Apache-2.0
// Second pass of the paper's method ([T] §3.6): computes ECCs from the sums, moves the point to the best candidate, and
// reports its offset to the host.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "optimise/mesh.glsl"
#include "optimise/candidates.glsl"

layout(local_size_x = kAlignmentInstances) in;

layout(binding = kBindingOutcomes, scalar) writeonly buffer Outcomes { AlignmentOutcome outcomes[]; };
layout(set = 1, binding = kBindingSumsOf, scalar) readonly buffer Sums { int64_t sums[]; };

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

shared EccScore scores[kAlignmentInstances];
shared bool usable[kAlignmentInstances];

EccScore scoreOf(uint instance) {
  const uint slots = eccSlots(todo.definition, mesh.members);
  const int64_t none = int64_t(0);
  EccScore score = EccScore(none, none, none);
  int64_t samples = none;
  for (uint s = 0u; s < slots; ++s) {
    const uint at = (instance * slots + s) * kEccSums;
    const int64_t x = sums[at], y = sums[at + 1u], n = sums[at + 5u];
    if (n == none) continue;
    score.varianceX += eccCentred(sums[at + 2u], x, x, n);
    score.varianceY += eccCentred(sums[at + 3u], y, y, n);
    score.covariance += eccCentred(sums[at + 4u], x, y, n);
    samples += n;
  }
  if (todo.definition == kEccConcatenated) return score;
  const ivec2 offset = offsetOf(todo.member, todo.first, todo.radius, todo.seed, instance);
  const int64_t cost = samples * eccAddedCost(displacementOf(todo.member, todo.first, offset),
                                         displacementOf(todo.member, todo.first, ivec2(0)), todo.rigidity);
  const int64_t added = todo.floor * samples;
  return EccScore(score.covariance + added - cost, score.varianceX + added, score.varianceY + added);
}

int64_t pixelsOf(uint instance) {
  const uint slots = eccSlots(todo.definition, mesh.members);
  int64_t samples = int64_t(0);
  for (uint s = 0u; s < slots; ++s) samples += sums[(instance * slots + s) * kEccSums + 5u];
  return samples / int64_t(3);
}

void main() {
  const uint lane = gl_LocalInvocationID.x, member = todo.member, point = todo.first;
  if (lane < todo.instances) {
    scores[lane] = scoreOf(lane);
    usable[lane] = lane > 0u && fits(member, point, offsetOf(member, point, todo.radius, todo.seed, lane)) &&
                   eccDefined(scores[lane]);
  }
  barrier();
  if (lane != 0u) return;
  uint best = 0u, judged = 1u;
  int64_t pixels = pixelsOf(0u);
  for (uint m = 1u; m < todo.instances; ++m) {
    pixels += pixelsOf(m);
    ++judged;
    if (usable[m] && (best == 0u || eccGreater(scores[m], scores[best]))) best = m;
  }
  const bool moves = best != 0u && eccWins(scores[best], scores[0]);
  const ivec2 offset = moves ? offsetOf(member, point, todo.radius, todo.seed, best) : ivec2(0);
  if (moves) positions[member * mesh.points + point] += offset;
  outcomes[0] = AlignmentOutcome(offset, judged, 0u, pixels);
}
