// SPDX-License-Identifier: Apache-2.0
// Weighted sums over cameras that come best first ([H] eqs 6 and 7). Weights reach down to 2^-1000 and below, so each
// sum is relative to the first weight that counts in it.
//
// Loops over cameras have their test in front. Mesa's llvmpipe 22.3 gives lanes that have left a loop zeros from storage
// buffers and goes on computing for them; what such a loop computes is right only if a further turn's test follows it.

struct HtmBlend {
  vec4 sum;  // of values, weighted; w: of the weights
  float reference;
};

HtmBlend htmNothing() {
  return HtmBlend(vec4(0.0), 0.0);
}

// share: how much the camera counts here, 0 to 1. log2Weight is not above that of any camera that was added before.
void htmAdd(inout HtmBlend blend, float log2Weight, float share, vec3 value) {
  blend.reference = blend.sum.w > 0.0 ? blend.reference : log2Weight;
  blend.sum += share * exp2(log2Weight - blend.reference) * vec4(value, 1.0);
}

// Whether cameras that are left, of which the weights have this sum, cannot change it any more.
bool htmSettled(HtmBlend blend, float log2Rest, float cut) {
  return blend.sum.w > 0.0 && exp2(log2Rest - blend.reference) <= cut * blend.sum.w;
}

bool htmHas(uvec2 members, uint camera) {
  return ((camera < 32u ? members.x >> camera : members.y >> (camera - 32u)) & 1u) != 0u;
}

bool htmAny(uvec2 members) {
  return (members.x | members.y) != 0u;
}

uint htmFirst(uvec2 members) {  // of some
  return members.x != 0u ? uint(findLSB(members.x)) : 32u + uint(findLSB(members.y));
}

uvec2 htmWithoutFirst(uvec2 members) {
  return members.x != 0u ? uvec2(members.x & (members.x - 1u), members.y) : uvec2(0u, members.y & (members.y - 1u));
}
