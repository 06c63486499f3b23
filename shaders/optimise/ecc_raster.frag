#version 460
// SPDX-License-Identifier: Apache-2.0
// First pass of the paper's method ([T] §3.6): a fragment adds samples of both photographs to its candidate's sums.
// Departure: values have eight more bits, and sums are 64 bits wide instead of shifting values to avoid an overflow.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "shared/alignment.h"

layout(binding = kBindingAlignment, scalar) readonly buffer Mesh { AlignmentMesh mesh; };
layout(set = 1, binding = kBindingSource) uniform sampler2D sourcePicture;
layout(set = 1, binding = kBindingTarget) uniform sampler2D targetPicture;
layout(set = 1, binding = kBindingSumsOf, scalar) buffer Sums { int64_t sums[]; };

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

layout(location = 0) in vec4 coordinates;
layout(location = 1) flat in uint instance;

ivec3 values(sampler2D picture, vec2 px, ivec2 size) {
  const vec3 colour = textureLod(picture, px / vec2(size), 0.0).rgb;
  return max(ivec3(round(colour * 65280.0)) - 32768, ivec3(-32767));
}

void add(uint slot, int64_t x, int64_t y, int64_t xx, int64_t yy, int64_t xy, uint n) {
  const uint at = slot * kEccSums;
  atomicAdd(sums[at], x);
  atomicAdd(sums[at + 1u], y);
  atomicAdd(sums[at + 2u], xx);
  atomicAdd(sums[at + 3u], yy);
  atomicAdd(sums[at + 4u], xy);
  atomicAdd(sums[at + 5u], int64_t(n));
}

void main() {
  const ivec3 x = values(sourcePicture, coordinates.xy, mesh.pictures[todo.member].size);
  const ivec3 y = values(targetPicture, coordinates.zw, mesh.pictures[todo.target].size);
  const ivec3 xx = x * x, yy = y * y, xy = x * y;
  const uint first = instance * eccSlots(todo.definition, mesh.members);
  if (todo.definition == kEccConcatenated) {
    add(first, int64_t(x.r + x.g + x.b), int64_t(y.r + y.g + y.b), int64_t(xx.r) + int64_t(xx.g) + int64_t(xx.b),
        int64_t(yy.r) + int64_t(yy.g) + int64_t(yy.b), int64_t(xy.r) + int64_t(xy.g) + int64_t(xy.b), 3u);
    return;
  }
  const uint target = todo.target < todo.member ? todo.target : todo.target - 1u;
  for (uint c = 0u; c < 3u; ++c)
    add(first + 3u * target + c, int64_t(x[c]), int64_t(y[c]), int64_t(xx[c]), int64_t(yy[c]), int64_t(xy[c]), 1u);
}
