#version 460
// SPDX-License-Identifier: Apache-2.0
// Moves the points of one class in one image, each to its best candidate ([T] §3.6–3.7). One workgroup per point, one
// lane per candidate. Points of a class share no triangle: no workgroup reads data that another one writes.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "optimise/star.glsl"
#include "optimise/candidates.glsl"

layout(local_size_x = kAlignmentGroup) in;

layout(binding = kBindingPoints, scalar) readonly buffer Points { uint points[]; };
layout(binding = kBindingOutcomes, scalar) writeonly buffer Outcomes { AlignmentOutcome outcomes[]; };

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

shared int reach;
shared uint instanceCount;
shared EccScore firstScore;
shared EccScore scores[kAlignmentInstances];
shared uint chosen[kAlignmentInstances];  // candidates to be scored in full, without candidate 0
shared uint chosenCount;
shared bool left[kAlignmentInstances];  // kept by pruning
shared EccScore bestScores[kAlignmentGroup];
shared uint bestInstances[kAlignmentGroup];
shared uint judgedBy[kAlignmentGroup];
shared int64_t pixelsBy[kAlignmentGroup];

EccScore judgedScore(uint member, uint point, uint instance, int step, int phase, inout uint judged,
                     inout int64_t pixels) {
  const ivec2 offset = offsetOf(member, point, reach, todo.seed, instance);
  const StarSums sums = judgedStar(member, point, offset, step, phase);
  ++judged;
  pixels += pixelsOf(sums);
  const int64_t increase = eccAddedCost(displacementOf(member, point, offset),
                                        displacementOf(member, point, ivec2(0)), todo.rigidity);
  return scoreOf(sums, todo.definition, todo.floor, increase);
}

// True if candidate a precedes b: a greater score, or an equal score and a smaller index.
bool comesBefore(EccScore a, uint instanceA, EccScore b, uint instanceB) {
  if (eccGreater(a, b)) return true;
  return instanceA < instanceB && !eccGreater(b, a);
}

// Finds the candidates that fit, and keeps the best if pruning is on; `chosen` is ascending.
void choose(uint member, uint point, uint lane, inout uint judged, inout int64_t pixels) {
  const uint seed = eccPointSeed(todo.seed, member, point);
  for (uint m = lane; m < instanceCount; m += kAlignmentGroup)
    chosen[m] = m > 0u && fits(member, point, offsetOf(member, point, reach, todo.seed, m)) ? 1u : 0u;
  barrier();
  if (lane == 0u) {
    chosenCount = 0u;
    for (uint m = 1u; m < instanceCount; ++m)
      if (chosen[m] != 0u) chosen[chosenCount++] = m;
  }
  barrier();
  if (todo.prune == 0u || chosenCount <= kAlignmentSurvivors) return;
  // Candidate 0 is scored too, as in the CPU implementation, so that both count the same work.
  if (lane == 0u)
    judgedScore(member, point, 0u, int(kAlignmentPruneRows), int(seed % kAlignmentPruneRows), judged, pixels);
  for (uint i = lane; i < chosenCount; i += kAlignmentGroup)
    scores[i] = judgedScore(member, point, chosen[i], int(kAlignmentPruneRows), int(seed % kAlignmentPruneRows), judged,
                            pixels);
  barrier();
  for (uint i = lane; i < chosenCount; i += kAlignmentGroup) {
    uint rank = 0u;
    for (uint j = 0u; j < chosenCount; ++j)
      if (j != i && comesBefore(scores[j], j, scores[i], i)) ++rank;
    left[i] = rank < kAlignmentSurvivors;
  }
  barrier();
  if (lane == 0u) {
    uint count = 0u;
    for (uint i = 0u; i < chosenCount; ++i)
      if (left[i]) chosen[count++] = chosen[i];
    chosenCount = count;
  }
  barrier();
}

void main() {
  const uint lane = gl_LocalInvocationID.x, at = todo.first + gl_WorkGroupID.x;
  const uint member = todo.member, point = points[at], outcome = todo.firstOutcome + gl_WorkGroupID.x;
  if (lane == 0u) {
    reach = maxMove(member, point, todo.radius);
    instanceCount =
        todo.scaled != 0u ? eccCandidateCount(todo.instances, reach, todo.radius) : todo.instances;
    if (reach == 0) instanceCount = 0u;
  }
  barrier();
  if (instanceCount == 0u) {
    if (lane == 0u) outcomes[outcome] = AlignmentOutcome(ivec2(0), 0u, 0u, int64_t(0));
    return;
  }
  uint judged = 0u;
  int64_t pixels = int64_t(0);
  choose(member, point, lane, judged, pixels);

  uint bestInstance = ~0u;
  EccScore best = EccScore(int64_t(0), int64_t(0), int64_t(0));
  for (uint i = lane; i <= chosenCount; i += kAlignmentGroup) {
    const uint instance = i == 0u ? 0u : chosen[i - 1u];
    const EccScore score = judgedScore(member, point, instance, 1, 0, judged, pixels);
    if (i == 0u)
      firstScore = score;
    else if (eccDefined(score) && (bestInstance == ~0u || eccGreater(score, best))) {
      best = score;
      bestInstance = instance;
    }
  }
  bestScores[lane] = best;
  bestInstances[lane] = bestInstance;
  judgedBy[lane] = judged;
  pixelsBy[lane] = pixels;
  barrier();
  if (lane != 0u) return;
  for (uint l = 1u; l < kAlignmentGroup; ++l) {
    judged += judgedBy[l];
    pixels += pixelsBy[l];
    if (bestInstances[l] != ~0u &&
        (bestInstance == ~0u || comesBefore(bestScores[l], bestInstances[l], best, bestInstance))) {
      best = bestScores[l];
      bestInstance = bestInstances[l];
    }
  }
  const bool moves = bestInstance != ~0u && eccWins(best, firstScore);
  const ivec2 offset = moves ? offsetOf(member, point, reach, todo.seed, bestInstance) : ivec2(0);
  if (moves) positions[member * mesh.points + point] += offset;
  outcomes[outcome] = AlignmentOutcome(offset, judged, 0u, pixels);
}
