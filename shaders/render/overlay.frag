#version 460
// SPDX-License-Identifier: Apache-2.0
// Draws an overlay over, or in place of, a cell's colour (shared/overlay.h). A specialisation constant selects the
// overlay, so that each costs only its own work.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_mapped.glsl"
#include "shared/overlay.h"

layout(constant_id = 10) const uint kOverlay = kOverlayWireframe;

layout(location = 6) in vec3 inCorner;           // barycentric coordinates
layout(location = 7) in vec2 inInverseDistance;  // ρ and its uncertainty
layout(push_constant, scalar) uniform Constants { OverlayConstants constants; };

layout(location = 0) out vec4 outColour;

vec3 edges() {
  const vec3 slope = sqrt(dFdx(inCorner) * dFdx(inCorner) + dFdy(inCorner) * dFdy(inCorner));
  const vec3 pixels = inCorner / max(slope, 1e-9);  // distance to each edge
  const float edge = edgeShare(min(pixels.x, min(pixels.y, pixels.z)));
  return mix(mappedCellColour(), rankColour(constants.rank, constants.ranks), edge);
}

// Returns the members' weights; all 0 if every member is masked.
vec4 weightsHere() {
  vec4 weights = vec4(0.0);
  Sampling samplings[kMaxMembers];
  for (int i = 0; i < kMembers; ++i) {
    weights[i] = cells[inCell].member[i].blend;
    if (kMasked) samplings[i] = sampling(i, inDetail);
  }
  if (kMasked) weights = shownMembers(samplings, weights).weights;
  return weights;
}

// Returns the blend of the members' colours, each with the weight at which its photograph is shown.
vec3 weightsColour() {
  const vec4 weights = weightsHere();
  vec4 one = vec4(0.0);
  one[kBlending != kBlend ? ditherMember(weights, noise(uvec2(gl_FragCoord.xy))) : 0] = 1.0;
  const vec4 shown = kBlending == kBlend ? weights : kBlending == kDither ? one : 0.5 * (weights + one);
  vec3 colour = vec3(0.0);
  for (int i = 0; i < kMembers; ++i) colour += shown[i] * memberColour(i);
  return colour;
}

// Luminance of a member beside the pixel, with the pixel's own gradients. The window extrapolates interpolated values
// linearly, so it lies in the plane of the triangle at its middle.
float luminanceAt(int member, Sampling here, vec3 coordinate) {
  const vec2 at = isPanorama(member) ? panoramaCoordinate(normalize(coordinate)) : coordinate.xy / coordinate.z;
  const vec3 colour = photograph(member, vec3(at, float(cells[inCell].member[member].layer)), here.dx, here.dy).rgb;
  return dot(exposed(member, colour), vec3(0.299, 0.587, 0.114));
}

float agreement() {
  Sampling samplings[kMaxMembers];
  vec3 dx[kMaxMembers], dy[kMaxMembers];
  vec4 middle = vec4(0.0);  // subtracted first, since sums of squares lose precision
  for (int i = 0; i < kMembers; ++i) {
    samplings[i] = sampling(i, inDetail);
    dx[i] = dFdx(inTexture[i]);
    dy[i] = dFdy(inTexture[i]);
    middle[i] = luminanceAt(i, samplings[i], inTexture[i]);
  }
  WindowSums sums = WindowSums(0.0, vec4(0.0), mat4(0.0));
  for (int y = -kAgreementReach; y <= kAgreementReach; ++y)
    for (int x = -kAgreementReach; x <= kAgreementReach; ++x) {
      vec4 v = vec4(0.0);
      for (int i = 0; i < kMembers; ++i)
        v[i] = luminanceAt(i, samplings[i], inTexture[i] + float(x) * dx[i] + float(y) * dy[i]) - middle[i];
      sums.count += 1.0;
      sums.sum += v;
      sums.products += outerProduct(v, v);
    }
  return agreementOf(sums, kMembers);
}

vec3 colourHere() {
  if (kOverlay == kOverlayWireframe) return edges();
  if (kOverlay == kOverlayTiers) return tinted(tierColour(0u), mappedCellColour());
  if (kOverlay == kOverlayWeights) return tinted(weightsColour(), mappedCellColour());
  vec3 colour = constants.counted != 0u ? overlapStep() : vec3(0.0);
  // ρ and clip space have the same scale per vertex, so ρ / w is the inverse depth.
  if (kOverlay == kOverlayDepth)
    colour = depthColour(inInverseDistance.x * gl_FragCoord.w, cells[inCell].nearDistance);
  if (kOverlay == kOverlayConfidence) colour = confidenceColour(inInverseDistance.x, inInverseDistance.y);
  if (kOverlay == kOverlayAgreement) colour = agreementColour(agreement());
  const bool gone = kMasked && weightsHere() == vec4(0.0);
  if (gone || (kDissolve && isDissolved(uvec2(gl_FragCoord.xy)))) discard;
  return colour;
}

void main() { outColour = vec4(colourHere(), kTier0Alpha); }
