// SPDX-License-Identifier: Apache-2.0
// Parameters of one morphing cell for the cell pass ([T] §2.5.1), for GLSL and C++.
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
IBR_CONSTANT uint kBlend = 0u;   // blend mode of the members' colours: [T] eq. 6
IBR_CONSTANT uint kDither = 1u;  // eq. 7
IBR_CONSTANT uint kMixed = 2u;   // mean of both
IBR_CONSTANT float kTier0Alpha = 1.0f;  // of the canvas: (255 − 64·tier) / 255; pixels of cells have tier 0
// Offset into the noise, so that dissolving and dithering are uncorrelated.
#ifdef __cplusplus
inline constexpr glm::uvec2 kDissolveOffset{29, 17};
#else
const uvec2 kDissolveOffset = uvec2(29, 17);
#endif

/// Minimum weight of a member of a mesh with masks: the member must show where all other members are masked, also where
/// its own blend weight is 0.
IBR_CONSTANT float kMinMaskedWeight = 1e-4f;

// Factor on gradients, √½: half a mip level finer than the footprint, since bilinear filtering blurs as much.
IBR_CONSTANT float kFinerDetail = 0.70710678f;

struct CellMember {
  mat3 toView;     // member's camera axes → virtual camera axes
  vec2 focal;      // of the photograph, in widths and heights
  vec2 principal;  // in widths and heights
  float position;  // λ_i, weight of the vertex position
  float blend;     // λ̂_i, weight of the colour
  uint layer;      // of the member's texture array
};

struct CellParameters {
  CellMember member[kMaxMembers];
  vec3 shift;  // t = Σ λ_i c_i − p in virtual camera axes
  float nearDistance;
  vec4 projection;  // clip x = projection.x·X − projection.y·Z, clip y = projection.z·Y − projection.w·Z
  uint unitRays;    // 1: the paper's morph, a_i = 1 and ρ = 0
  float detail;     // factor on gradients; kFinerDetail: as much detail as the image shows
  uint table;       // colour table
  float opacity;    // share of pixels that are drawn, chosen by blue noise
  uvec2 noise;      // offset of the noise lookup, px, less than kNoiseSize
};

struct MemberExposure {
  vec3 gain;   // factor on the photograph's linear light; 1: unchanged
  vec3 slope;  // gain^(1 / 2.4)
};

/// Exposures of the draw item whose CellParameters have the same index.
struct CellExposure {
  MemberExposure member[kMaxMembers];
};

/// Returns the share of a member that its mask leaves, for the mean of the mask's texels. 1 inside; 0 as soon as half
/// the sampled area is masked, so that masked colours hardly show.
IBR_FUNCTION float maskShare(float alpha) {
  return clamp(2.0f * alpha - 1.0f, 0.0f, 1.0f);
}

/// Returns the member for random number r, 0 <= r < 1 ([T] eq. 7). The weights sum to 1 except for rounding. The last
/// member with a weight takes the rest, so that every pixel gets a valid member.
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

/// Multiplies the linear light of a display-encoded value (sRGB, IEC 61966-2-1) by `gain`; slope = gain^(1 / 2.4). Not
/// clamped. Exact except near the end of the curve's straight part. There the result is too small by less than 0.0023
/// (too large for a gain below 1), for gains of 1/8 to 8. A gain of 1 changes no bit.
IBR_FUNCTION float exposedValue(float value, float gain, float slope) {
  const float curved = slope * value + 0.055f * (slope - 1.0f), straight = gain * value;
  return gain < 1.0f ? max(curved, straight) : min(curved, straight);
}

/// Applies the gain to a photograph's colour. A clipped value was at least as bright as it is stored. Darkening is
/// therefore reduced from kClipStart on, and omitted from kClipEnd on, so that white does not turn grey or brown.
IBR_CONSTANT float kClipStart = 0.9f, kClipEnd = 0.99f;
IBR_FUNCTION vec3 exposedColour(vec3 colour, vec3 gain, vec3 slope) {
  const vec3 exposed =
      vec3(exposedValue(colour.r, gain.r, slope.r), exposedValue(colour.g, gain.g, slope.g),
           exposedValue(colour.b, gain.b, slope.b));
  const float brightest = max(colour.r, max(colour.g, colour.b));
  const float share = clamp((brightest - kClipStart) / (kClipEnd - kClipStart), 0.0f, 1.0f);
  const vec3 lost = colour - exposed;
  return exposed + share * vec3(max(lost.r, 0.0f), max(lost.g, 0.0f), max(lost.b, 0.0f));
}

/// Returns the pseudo-random number of a rank: (rank + ½) / count, never 0 or 1.
IBR_FUNCTION float noiseFromRank(uint rank) {
  return (float(rank) + 0.5f) / float(kNoiseSize * kNoiseSize);
}

IBR_SHARED_END

#endif
