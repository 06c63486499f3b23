// SPDX-License-Identifier: Apache-2.0
// Colours of overlays over or in place of an image (Overlay in ibr/render_settings.h), for GLSL and C++: shaders and
// legends use the same functions.
//
// Measured values use one ramp from dark violet to light yellow. Its lightness (CIE L*) rises evenly, also for
// colour-blind viewers. Categories use colours of Okabe and Ito's palette.
#ifndef IBR_SHARED_OVERLAY_H
#define IBR_SHARED_OVERLAY_H

#include "shared/cell.h"
#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kSetMeshes = 2;  // descriptor set

IBR_CONSTANT uint kOverlayWireframe = 1u;  // values of Overlay
IBR_CONSTANT uint kOverlayTiers = 2u;
IBR_CONSTANT uint kOverlayWeights = 3u;
IBR_CONSTANT uint kOverlayConfidence = 4u;
IBR_CONSTANT uint kOverlayDepth = 5u;
IBR_CONSTANT uint kOverlayOverlap = 6u;
IBR_CONSTANT uint kOverlayAgreement = 7u;

struct OverlayConstants {
  uint firstIndex;        // of the cell
  uint firstFloat;        // of the mesh's vertices
  uint firstUncertainty;  // of the cell
  float rank;             // 0: best
  float ranks;            // number of ranks
  uint counted;  // 1: the overlap counts this cell
};

/// Returns a colour of the ramp from dark (0) to light (1).
IBR_FUNCTION vec3 rampColour(float share) {
  const float x = 4.0f * clamp(share, 0.0f, 1.0f);
  const vec3 violet = vec3(0.23f, 0.02f, 0.35f), blue = vec3(0.21f, 0.29f, 0.57f), teal = vec3(0.11f, 0.54f, 0.55f),
             green = vec3(0.46f, 0.76f, 0.31f), yellow = vec3(0.98f, 0.91f, 0.28f);
  return violet + clamp(x, 0.0f, 1.0f) * (blue - violet) + clamp(x - 1.0f, 0.0f, 1.0f) * (teal - blue) +
         clamp(x - 2.0f, 0.0f, 1.0f) * (green - teal) + clamp(x - 3.0f, 0.0f, 1.0f) * (yellow - green);
}

/// Colour for missing values; not a colour of the ramp.
IBR_FUNCTION vec3 unknownColour() { return vec3(0.8f); }

/// Returns the image's brightness in another colour: bright where the image is bright, and never so dark that the
/// colour is not recognisable.
IBR_FUNCTION vec3 tinted(vec3 colour, vec3 picture) {
  const float light = 0.299f * picture.x + 0.587f * picture.y + 0.114f * picture.z;
  return (0.3f + 0.7f * light) * colour;
}

/// Returns an edge's share of a pixel whose centre has this distance from the edge, px. The line is 1.5 px wide, half
/// of the width in each of the two triangles that share the edge.
IBR_FUNCTION float edgeShare(float pixels) { return clamp(1.25f - pixels, 0.0f, 1.0f); }

/// Returns a heat colour of a cell's rank ([T] fig. 4): light yellow for the main cell, then orange, red, dark blue.
IBR_FUNCTION vec3 rankColour(float rank, float ranks) {
  const float heat = ranks > 1.0f ? 3.0f * clamp(rank / (ranks - 1.0f), 0.0f, 1.0f) : 0.0f;
  const vec3 yellow = vec3(1.0f, 0.98f, 0.6f), orange = vec3(1.0f, 0.55f, 0.1f), red = vec3(0.8f, 0.1f, 0.2f),
             blue = vec3(0.15f, 0.15f, 0.65f);
  const vec3 colour = yellow + clamp(heat, 0.0f, 1.0f) * (orange - yellow) +
                      clamp(heat - 1.0f, 0.0f, 1.0f) * (red - orange) + clamp(heat - 2.0f, 0.0f, 1.0f) * (blue - red);
  return colour;
}

/// Tier 0 is grey, so that pixels on which photographs do not agree stand out. A hole has the colour of tier 3, which
/// covers the hole evenly.
IBR_FUNCTION vec3 tierColour(uint tier) {
  if (tier == 0u) return vec3(1.0f);
  if (tier == 2u) return vec3(0.337f, 0.706f, 0.914f);  // sky blue
  return vec3(0.941f, 0.894f, 0.259f);  // yellow
}

/// Colour of a cell's member, or of one of a gathered pixel's photographs, best first.
IBR_FUNCTION vec3 memberColour(int member) {
  if (member == 0) return vec3(0.0f, 0.447f, 0.698f);  // blue
  if (member == 1) return vec3(0.941f, 0.894f, 0.259f);  // yellow
  if (member == 2) return vec3(0.835f, 0.369f, 0.0f);  // vermillion
  return vec3(0.8f, 0.475f, 0.655f);  // reddish purple
}

// Uncertainty of depth, σ / ρ: light is certain. The scale is logarithmic.
IBR_CONSTANT float kMinUncertainty = 0.001f;
IBR_CONSTANT float kMaxUncertainty = 1.0f;

/// Points without depth (ρ = 0) have the largest uncertainty.
IBR_FUNCTION vec3 confidenceColour(float inverseDistance, float uncertainty) {
  if (!(inverseDistance > 0.0f)) return rampColour(0.0f);
  const float certain = kMaxUncertainty / max(uncertainty / inverseDistance, kMinUncertainty);
  return rampColour(log2(certain) / log2(kMaxUncertainty / kMinUncertainty));
}

// Depth along the viewing axis, in units of FramePlan::nearDistance: light is near. The scale is logarithmic.
IBR_CONSTANT float kNearestDepth = 8.0f;
IBR_CONSTANT float kFarthestDepth = 2048.0f;

/// `inverseDepth`: 1 / depth; 0: unknown or infinite.
IBR_FUNCTION vec3 depthColour(float inverseDepth, float nearDistance) {
  const float closeness = kFarthestDepth * max(inverseDepth * nearDistance, 0.0f);
  return rampColour(log2(max(closeness, 1.0f)) / log2(kFarthestDepth / kNearestDepth));
}

/// Number of cells that show a pixel. Each adds this colour, which saturates blue, then green, then red.
IBR_FUNCTION vec3 overlapStep() { return vec3(12.0f, 32.0f, 85.0f) / 255.0f; }
IBR_FUNCTION vec3 overlapColour(int cells) {
  const vec3 sum = float(cells) * overlapStep();
  return vec3(min(sum.x, 1.0f), min(sum.y, 1.0f), min(sum.z, 1.0f));
}

// Agreement of photographs: zero-mean normalised correlation of their luminances in a window of the image, mean over
// the pairs of members.
IBR_CONSTANT int kAgreementReach = 3;               // pixels to each side
IBR_CONSTANT float kMinContrast = 2.0f / 255.0f;  // standard deviation below which a window is flat: no value

/// Sums over a window: values v of four members, and their products.
struct WindowSums {
  float count;
  vec4 sum;
  mat4 products;
};

/// Returns the mean correlation over pairs of members that both have contrast, −1 to 1; 2: there is no such pair.
IBR_FUNCTION float agreementOf(WindowSums sums, int members) {
  float total = 0.0f, pairs = 0.0f;
  const float least = sums.count * kMinContrast * kMinContrast;
  for (int i = 1; i < members; ++i)
    for (int j = 0; j < i; ++j) {
      const float a = sums.products[i][i] - sums.sum[i] * sums.sum[i] / sums.count;
      const float b = sums.products[j][j] - sums.sum[j] * sums.sum[j] / sums.count;
      if (a < least || b < least) continue;
      total += clamp((sums.products[i][j] - sums.sum[i] * sums.sum[j] / sums.count) / sqrt(a * b), -1.0f, 1.0f);
      pairs += 1.0f;
    }
  return pairs > 0.0f ? total / pairs : 2.0f;
}

/// Light: agreement. Dark: no correlation, or a negative one.
IBR_FUNCTION vec3 agreementColour(float agreement) {
  return agreement > 1.5f ? unknownColour() : rampColour(agreement);
}

IBR_SHARED_END

#endif
