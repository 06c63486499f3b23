#version 460
// SPDX-License-Identifier: Apache-2.0
// Scores points at their current positions in one image; one lane per point.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "optimise/star.glsl"

layout(local_size_x = kAlignmentGroup) in;

layout(binding = kBindingJudgements, scalar) writeonly buffer Judgements { AlignmentJudgement judgements[]; };

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

void main() {
  const uint point = gl_GlobalInvocationID.x;
  if (point >= mesh.points) return;
  const StarSums sums = judgedStar(todo.member, point, ivec2(0), 1, 0);
  const uint at = todo.member * mesh.points + point;
  for (uint t = 0u; t < 3u; ++t) judgements[at].targets[t] = sums.targets[t];
  judgements[at].whole = sums.whole ? int64_t(1) : int64_t(0);
}
