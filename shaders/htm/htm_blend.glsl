// SPDX-License-Identifier: Apache-2.0
// Weighted sums over cameras in the order best first ([H] eqs 6 and 7). Weights may be 2^-1000 or smaller, so each sum
// is relative to its first weight.
//
// Loops over cameras test their condition at the top. In Mesa's llvmpipe 22.3, lanes that have left a loop read zeros
// from storage buffers and go on computing. Their results are right only if another test of the condition follows.

struct HtmBlend {
  vec4 sum;  // weighted sum of values; w: sum of weights
  float reference;
};

HtmBlend htmNothing() {
  return HtmBlend(vec4(0.0), 0.0);
}

// share: visibility of the camera, 0 to 1. log2Weight must not exceed that of any camera added before.
void htmAdd(inout HtmBlend blend, float log2Weight, float share, vec3 value) {
  blend.reference = blend.sum.w > 0.0 ? blend.reference : log2Weight;
  blend.sum += share * exp2(log2Weight - blend.reference) * vec4(value, 1.0);
}

// True if the remaining cameras, with this sum of weights, cannot change the result any more.
bool htmSettled(HtmBlend blend, float log2Rest, float cut) {
  return blend.sum.w > 0.0 && exp2(log2Rest - blend.reference) <= cut * blend.sum.w;
}

bool htmHas(uvec2 members, uint camera) {
  return ((camera < 32u ? members.x >> camera : members.y >> (camera - 32u)) & 1u) != 0u;
}

bool htmAny(uvec2 members) {
  return (members.x | members.y) != 0u;
}

uint htmFirst(uvec2 members) {  // members must not be empty
  return members.x != 0u ? uint(findLSB(members.x)) : 32u + uint(findLSB(members.y));
}

uvec2 htmWithoutFirst(uvec2 members) {
  return members.x != 0u ? uvec2(members.x & (members.x - 1u), members.y) : uvec2(0u, members.y & (members.y - 1u));
}
