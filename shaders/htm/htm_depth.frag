#version 460
// SPDX-License-Identifier: Apache-2.0
// What a camera sees, as inverse depth along its axis: linear in the picture over a plane, so that it may be filtered.

layout(location = 0) out float outInverseDepth;

void main() {
  outInverseDepth = gl_FragCoord.w;
}
