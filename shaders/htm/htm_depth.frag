#version 460
// SPDX-License-Identifier: Apache-2.0
// Inverse depth along a camera's axis. Over a plane it is linear in the image, so it may be filtered.

layout(location = 0) out float outInverseDepth;

void main() {
  outInverseDepth = gl_FragCoord.w;
}
