// SPDX-License-Identifier: Apache-2.0
// One morphing cell as the cell pass sees it ([T] §2.5.1; ARCHITECTURE §5), for GLSL and C++.
#ifndef IBR_SHARED_CELL_H
#define IBR_SHARED_CELL_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kMaxMembers = 4;
IBR_CONSTANT int kSetFrame = 0;  // descriptor sets
IBR_CONSTANT int kSetCell = 1;
IBR_CONSTANT int kBindingParameters = 0;   // of kSetFrame: CellParameters[]
IBR_CONSTANT int kBindingNoise = 1;        // of kSetFrame: uint[kNoiseSize²], each rank once
IBR_CONSTANT int kBindingFrameTables = 2;  // of kSetFrame: colour tables, read where colours are mapped
IBR_CONSTANT int kBindingExposures = 3;    // of kSetFrame: CellExposure[], read where photographs have gains
IBR_CONSTANT int kNoiseSize = 64;
IBR_CONSTANT uint kBlend = 0u;   // how colours become one: [T] eq. 6
IBR_CONSTANT uint kDither = 1u;  // eq. 7
IBR_CONSTANT uint kMixed = 2u;   // their mean
IBR_CONSTANT float kTier0Alpha = 1.0f;  // of the canvas: (255 − 64·tier) / 255, and a cell's pixels are of tier 0
#ifdef __cplusplus
inline constexpr glm::uvec2 kDissolveOffset{29,
                                            17};  // into the noise, so that dissolving and dithering do not conspire
#else
const uvec2 kDissolveOffset = uvec2(29, 17);
#endif

/// Where photographs have masks, a member of a mesh that agrees (tier 0) has at least this weight: where the others are
/// masked, it is what shows.
IBR_CONSTANT float kLeastMaskedWeight = 1e-4f;

// Photographs are read half a mip level finer than their footprint asks for: bilinear filtering blurs as much as that.
IBR_CONSTANT float kFinerDetail = 0.70710678f;

struct CellMember {
  mat3 toView;     // member's camera axes → virtual camera axes
  vec2 focal;      // of the photograph, in widths and heights
  vec2 principal;  // likewise
  float position;  // λ_i, weight of the vertex position
  float blend;     // λ̂_i, weight of the colour
  uint layer;      // of the member's array image
};

struct CellParameters {
  CellMember member[kMaxMembers];
  vec3 shift;  // t = Σ λ_i c_i − p in virtual camera axes
  float nearDistance;
  vec4 projection;  // clip x = projection.x·X − projection.y·Z, clip y = projection.z·Y − projection.w·Z
  uint unitRays;    // 1: the paper's morph, a_i = 1 and ρ = 0
  float detail;     // of the photographs: gradients are multiplied by it, kFinerDetail for as much as the picture shows
  uint table;       // colour table
  float opacity;    // share of pixels that are drawn, chosen by blue noise
  uvec2 noise;      // added to the pixel that noise is looked up for: less than kNoiseSize
};

struct MemberExposure {
  vec3 gain;   // of the photograph's linear light; 1 where it is shown as it is
  vec3 slope;  // gain^(1 / 2.4)
};

/// Beside the CellParameters of the same index.
struct CellExposure {
  MemberExposure member[kMaxMembers];
};

/// How much of a member its mask leaves where the mask's texels have this mean: all of it inside, nothing as soon as
/// half of what is sampled is masked, so that hardly a masked colour is seen.
IBR_FUNCTION float maskShare(float alpha) {
  return clamp(2.0f * alpha - 1.0f, 0.0f, 1.0f);
}

/// Member chosen for random number r, 0 <= r < 1 ([T] eq. 7). Weights sum to 1 but for rounding; the last member that
/// has any weight takes what rounding leaves over, so that every pixel gets a member that exists.
IBR_FUNCTION int ditherMember(vec4 weights, float r) {
  int chosen = 0;
  float sum = 0.0f;
  for (int i = 0; i < kMaxMembers; ++i) {
    if (weights[i] <= 0.0f) continue;
    chosen = i;
    sum += weights[i];
    if (r < sum) break;
  }
  return chosen;
}

/// A display-encoded value (sRGB, IEC 61966-2-1) whose linear light is multiplied by `gain`; slope = gain^(1 / 2.4). Not
/// clamped. Exact but between the ends of the curve's straight part before and after, where it is too small by less than
/// 0.0023 (too large for a gain below 1) for gains of 1/8 to 8; a gain of 1 changes no bit.
IBR_FUNCTION float exposedValue(float value, float gain, float slope) {
  const float curved = slope * value + 0.055f * (slope - 1.0f), straight = gain * value;
  return gain < 1.0f ? max(curved, straight) : min(curved, straight);
}

/// A photograph's colour with its gain. What is clipped was at least as bright as it looks, of unknown colour: from kClips
/// on it is made no darker than it is, little by little, so that white does not turn grey or brown.
IBR_CONSTANT float kClips = 0.9f, kClipped = 0.99f;
IBR_FUNCTION vec3 exposedColour(vec3 colour, vec3 gain, vec3 slope) {
  const vec3 exposed =
      vec3(exposedValue(colour.r, gain.r, slope.r), exposedValue(colour.g, gain.g, slope.g),
           exposedValue(colour.b, gain.b, slope.b));
  const float share = clamp((max(colour.r, max(colour.g, colour.b)) - kClips) / (kClipped - kClips), 0.0f, 1.0f);
  const vec3 lost = colour - exposed;
  return exposed + share * vec3(max(lost.r, 0.0f), max(lost.g, 0.0f), max(lost.b, 0.0f));
}

/// Pseudo-random number of a rank: (rank + ½) / count, never 0 or 1.
IBR_FUNCTION float noiseFromRank(uint rank) {
  return (float(rank) + 0.5f) / float(kNoiseSize * kNoiseSize);
}

IBR_SHARED_END

#endif
