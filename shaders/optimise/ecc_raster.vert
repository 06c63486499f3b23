#version 460
// SPDX-License-Identifier: Apache-2.0
// First pass of the paper's method ([T] §3.6): one instance per candidate draws the star at the mean of source and
// target. The viewport is 2¹⁴ px wide and high, which represents positions in 2⁻⁸ px exactly.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#define POSITIONS_ARE_READ
#include "optimise/mesh.glsl"
#include "optimise/candidates.glsl"

layout(push_constant, scalar) uniform Step { AlignmentStep todo; };

layout(location = 0) out vec4 coordinates;  // of source and target, px
layout(location = 1) flat out uint instance;

void main() {
  const uvec2 edge = starEdges[starFirst[todo.first] + uint(gl_VertexIndex) / 3u];
  const uint corner = uint(gl_VertexIndex) % 3u;
  const uint point = corner == 0u ? todo.first : (corner == 1u ? edge.x : edge.y);
  instance = uint(gl_InstanceIndex);
  ivec2 source = positionIn(todo.member, point);
  if (corner == 0u) source += offsetOf(todo.member, point, todo.radius, todo.seed, instance);
  const ivec2 target = positionIn(todo.target, point);
  coordinates = vec4(vec2(source), vec2(target)) / 128.0;
  gl_Position = vec4(vec2(source + target) / (256.0 * 8192.0) - 1.0, 0.5, 1.0);
}
