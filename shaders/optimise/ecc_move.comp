#version 460
// SPDX-License-Identifier: Apache-2.0
// Moves the points of one class in one picture, each to the best of its candidates ([T] §3.6–3.7); a workgroup is a point,
// a lane a candidate. Points of a class share no triangle, so nothing that a workgroup reads is written by another.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "optimise/star.glsl"

layout(local_size_x = kAlignmentGroup) in;

layout(binding = kBindingKeptFirst, scalar) readonly buffer KeptFirst { uint keptFirst[]; };
layout(binding = kBindingKeptEdges, scalar) readonly buffer KeptEdges { uvec3 keptEdges[]; };
layout(binding = kBindingBorder, scalar) readonly buffer Borders { uvec3 borders[]; };
layout(binding = kBindingPoints, scalar) readonly buffer Points { uint points[]; };
layout(binding = kBindingOutcomes, scalar) writeonly buffer Outcomes { AlignmentOutcome outcomes[]; };

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

shared int reach;
shared uint instanceCount;
shared EccScore firstScore;
shared EccScore scores[kAlignmentInstances];
shared uint chosen[kAlignmentInstances];  // candidates to be judged whole, the first one left out
shared uint chosenCount;
shared bool left[kAlignmentInstances];  // by pruning
shared EccScore bestScores[kAlignmentGroup];
shared uint bestInstances[kAlignmentGroup];
shared uint judgedBy[kAlignmentGroup];
shared int64_t pixelsBy[kAlignmentGroup];

int reachOf(uint member, uint point) {
  int most = todo.radius;
  for (uint e = starFirst[point]; e < starFirst[point + 1u]; ++e) {
    const uvec2 edge = starEdges[e];
    const ivec2 p = positionIn(member, point), a = positionIn(member, edge.x), b = positionIn(member, edge.y);
    most = min(most, eccReach(p, a, b));
    for (uint k = 0u; k < mesh.members; ++k)
      if (k != member)
        most = min(most, eccReach(p + positionIn(k, point), a + positionIn(k, edge.x), b + positionIn(k, edge.y)));
    if (mesh.members > 2u)
      most = min(most, eccReach(sumOfPositions(point), sumOfPositions(edge.x), sumOfPositions(edge.y)));
  }
  return most;
}

ivec2 offsetOf(uint member, uint point, uint instance) {
  if (instance == 0u) return ivec2(0);
  const uint own = eccHash(eccPointSeed(todo.seed, member, point), instance);
  const uvec3 border = borders[point];
  if (border.z == kBorderInterior) return eccInDisc(own, reach);
  return eccAlong(own, reach, positionIn(member, border.y) - positionIn(member, border.x));
}

bool unfolded(ivec2 a, ivec2 b, ivec2 c) { return eccArea(a, b, c) > int64_t(0); }

bool fits(uint member, uint point, ivec2 offset) {
  const ivec2 to = positionIn(member, point) + offset, most = mesh.pictures[member].size * 128;
  if (to.x < 0 || to.y < 0 || to.x > most.x || to.y > most.y) return false;
  for (uint e = starFirst[point]; e < starFirst[point + 1u]; ++e) {
    const uvec2 edge = starEdges[e];
    const ivec2 a = positionIn(member, edge.x), b = positionIn(member, edge.y);
    if (!unfolded(to, a, b)) return false;
    for (uint k = 0u; k < mesh.members; ++k)
      if (k != member && !unfolded(to + positionIn(k, point), a + positionIn(k, edge.x), b + positionIn(k, edge.y)))
        return false;
    if (mesh.members > 2u &&
        !unfolded(sumOfPositions(point) + offset, sumOfPositions(edge.x), sumOfPositions(edge.y)))
      return false;
  }
  for (uint e = keptFirst[point]; e < keptFirst[point + 1u]; ++e) {
    const uvec3 edge = keptEdges[e];
    if (((edge.z >> member) & 1u) != 0u && !unfolded(to, positionIn(member, edge.x), positionIn(member, edge.y)))
      return false;
  }
  return true;
}

EccScore judgedScore(uint member, uint point, uint instance, int step, int phase, inout uint judged,
                     inout int64_t pixels) {
  const StarSums sums = judgedStar(member, point, offsetOf(member, point, instance), step, phase);
  ++judged;
  pixels += pixelsOf(sums);
  return scoreOf(sums, todo.definition, todo.floor);
}

// Whether candidate a comes before b: greater, or not less and earlier.
bool comesBefore(EccScore a, uint instanceA, EccScore b, uint instanceB) {
  if (eccGreater(a, b)) return true;
  return instanceA < instanceB && !eccGreater(b, a);
}

// Candidates that fit, of which pruning leaves the best; in `chosen`, ascending.
void choose(uint member, uint point, uint lane, inout uint judged, inout int64_t pixels) {
  const uint seed = eccPointSeed(todo.seed, member, point);
  for (uint m = lane; m < instanceCount; m += kAlignmentGroup)
    chosen[m] = m > 0u && fits(member, point, offsetOf(member, point, m)) ? 1u : 0u;
  barrier();
  if (lane == 0u) {
    chosenCount = 0u;
    for (uint m = 1u; m < instanceCount; ++m)
      if (chosen[m] != 0u) chosen[chosenCount++] = m;
  }
  barrier();
  if (todo.prune == 0u || chosenCount <= kAlignmentLeft) return;
  // The first is looked at, too, as the processor's way does, so that both count the same work.
  if (lane == 0u)
    judgedScore(member, point, 0u, int(kAlignmentRows), int(seed % kAlignmentRows), judged, pixels);
  for (uint i = lane; i < chosenCount; i += kAlignmentGroup)
    scores[i] = judgedScore(member, point, chosen[i], int(kAlignmentRows), int(seed % kAlignmentRows), judged, pixels);
  barrier();
  for (uint i = lane; i < chosenCount; i += kAlignmentGroup) {
    uint rank = 0u;
    for (uint j = 0u; j < chosenCount; ++j)
      if (j != i && comesBefore(scores[j], j, scores[i], i)) ++rank;
    left[i] = rank < kAlignmentLeft;
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
    reach = reachOf(member, point);
    instanceCount =
        todo.scaled != 0u ? eccInstances(todo.instances, reach, todo.radius) : todo.instances;
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
  const ivec2 offset = moves ? offsetOf(member, point, bestInstance) : ivec2(0);
  if (moves) positions[member * mesh.points + point] += offset;
  outcomes[outcome] = AlignmentOutcome(offset, judged, 0u, pixels);
}
