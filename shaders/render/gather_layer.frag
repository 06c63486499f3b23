#version 460
// SPDX-License-Identifier: Apache-2.0
// Writes a candidate's hypothesis for a pixel of the vote: ρ along the view's axis, trust, consensus. Zeros: none.
#extension GL_GOOGLE_include_directive : require

layout(location = 0) in vec3 inHypothesis;
layout(location = 0) out uvec2 outHypothesis;

void main() {
  outHypothesis = uvec2(floatBitsToUint(max(inHypothesis.x * gl_FragCoord.w, 0.0)), packHalf2x16(inHypothesis.yz));
}
