// SPDX-License-Identifier: Apache-2.0
// Vote for depth, then gather colours from the photographs that saw it (Composition::gathered), for GLSL and C++.
//
//   layers   the mesh of every candidate photograph is drawn into a tile of an atlas: ρ, trust, consensus
//   vote     hypotheses of a pixel support each other. Each is present as a surface by its share of the largest
//            support, times 1 − kernel / .25, at least 0, for each of more support; from front to back it shows
//            presence · opacity of what those before it leave. The two that show most are the pixel's surfaces
//   gather   a surface's colour is the mean of the N photographs that see it best, each read as coarsely as the
//            surface's uncertain depth moves it: by angle · uncertainty / ρ, the angle between the view's ray and its own.
//            A photograph's own surface hides another only where their uncertain depths tell them apart
//
// All lengths are in units of b, the median spacing of the capture sites; ρ is 1 / length.
#ifndef IBR_SHARED_GATHER_H
#define IBR_SHARED_GATHER_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kMaxGathered = 16;       // candidate photographs
IBR_CONSTANT int kMaxGatheredColours = 8;  // photographs of a pixel's colour
IBR_CONSTANT int kGatherColumns = 4;       // tiles of the atlas in a row
IBR_CONSTANT int kGatherGroup = 8;         // threads of a workgroup, each way
IBR_CONSTANT int kSetGatherView = 0;       // descriptor sets
IBR_CONSTANT int kSetGatherTextures = 1;
IBR_CONSTANT int kBindingGatherViews = 0;  // of kSetGatherView: GatherView[]
IBR_CONSTANT int kBindingGatherAtlas = 1;
IBR_CONSTANT int kBindingGatherVote = 2;  // written by the vote
IBR_CONSTANT int kBindingGatherVoted = 3;  // the same image, read by the gather
IBR_CONSTANT int kBindingGatherHoles = 4;
IBR_CONSTANT int kBindingGatherPhotographs = 0;  // of kSetGatherTextures
IBR_CONSTANT int kBindingGatherDepths = 1;
IBR_CONSTANT int kBindingGatherSamplers = 2;

// Constants of the method; ±50 % of any changes the picture by .05 dB.
IBR_CONSTANT float kGatherNear = 0.01f;           // distance within which surfaces are not told apart, b
IBR_CONSTANT float kGatherNearness = 0.3f;        // of a vote's weight: trust / (kGatherNearness + (d / b)²)
IBR_CONSTANT float kGatherAngleFloor = 0.03f;     // radians, added to every angle
IBR_CONSTANT float kGatherDistanceCost = 0.001f;  // radians a b of distance
IBR_CONSTANT float kGatherBorder = 0.04f;         // of the photograph's width, along which it comes and goes
IBR_CONSTANT float kGatherMaxResolution = 1.5f;   // of the view's: a finer photograph is no better
IBR_CONSTANT float kGatherHidden = 0.002f;        // a hidden photograph is better than none
IBR_CONSTANT float kGatherBehind = 0.25f;         // visibility where the photograph's own surface stands behind
IBR_CONSTANT float kGatherOwnPlace = 0.01f;       // radians of cost within which hiding and borders stop to count
IBR_CONSTANT float kGatherLeastApart = 1e-6f;
IBR_CONSTANT float kGatherSameSurface = 0.25f;  // kernel from which on the lesser hypothesis is no surface of its own
IBR_CONSTANT float kGatherFullConsensus = 0.9f;  // from which on a surface that is present hides all behind it
IBR_CONSTANT float kGatherColourSpread = 15.0f;  // 8-bit levels; a surface whose colours differ by this counts half
IBR_CONSTANT float kGatherSteps = 2.0f;          // of the vote's tolerance: steps …
IBR_CONSTANT float kGatherShare = 0.01f;         // … and a share of ρ
// One standard deviation of a confirmed ρ is the hypotenuse of two: steps, and the spread of the vote times what follows.
// Fitted to the exact depth of a street, where 68 % are to lie within one and 95 % within two.
IBR_CONSTANT float kGatherStepDeviation = 0.18f;    // steps
IBR_CONSTANT float kGatherSpreadDeviation = 0.85f;  // of the spread …
IBR_CONSTANT float kGatherColourDeviation = 4.0f;   // … times 1 + this × the colours' deviation / kGatherColourSpread …
IBR_CONSTANT float kGatherMostColours = 2.0f;       // … which counts up to here
IBR_CONSTANT float kGatherAloneSpread = 0.05f;      // of a hypothesis that no other candidate has one beside
IBR_CONSTANT float kGatherSpreadLevels = 31.0f;     // of the code: kGatherSpreadOctave a factor of 2, the last one is 1
IBR_CONSTANT float kGatherSpreadOctave = 3.0f;
IBR_CONSTANT float kGatherCompleted = 0.155f;    // trust: a hypothesis below it was completed, not matched
IBR_CONSTANT float kGatherSureConsensus = 0.5f;  // from which on ρ counts as exact; below it …
IBR_CONSTANT float kGatherUnsure = 0.1f;         // … it may be off by up to this share of itself: a standard deviation
IBR_CONSTANT float kGatherUnsureSigmas = 3.0f;   // within so many of both surfaces' nothing is hidden

/// A photograph as one view uses it. "Photograph axes": those of its camera.
struct GatherCandidate {
  mat3 toView;  // photograph axes → view axes
  vec3 place;   // of the photograph from the view, view axes
  mat3 toPhotograph;
  vec3 shift;      // of the view from the photograph, photograph axes
  vec2 focal;      // in widths and heights; of a panorama unused
  vec2 principal;  // likewise
  float aspect;    // height / width
  float focalPx;   // px a radian in the middle
  float weight;    // as a whole, 0 to 1
  float voteWeight;    // weight / (kGatherNearness + d²)
  float distanceCost;  // radians
  float step;          // ρ that moves a point by 2 px over b
  float residual;      // ρ that moves a point by the reprojection residual over b
  float depthScale;    // ρ of a red of 1 in its depth texture
  uint slot;           // of its texture array, and layer
  uint layer;
  uint depthSlot;  // of its depth's
  uint depthLayer;
  uint panorama;  // 1: it is one
  vec3 gain;      // of its linear light
  vec3 slope;     // gain^(1 / 2.4)
};

struct GatherView {
  GatherCandidate candidate[kMaxGathered];
  vec4 projection;  // as CellParameters::projection
  vec4 toRay;       // ray.xy = toRay.xy · pixel + toRay.zw, pixels of the image as it is drawn; ray.z = −1
  float spacing;    // b, world units
  float step;       // median of the candidates' steps
  float focalPx;    // px a radian in the middle of the image as it is drawn
  float detail;     // as CellParameters::detail
  float nearDistance;  // FramePlan::nearDistance, b
  uint count;          // candidates
  int lowestTier;      // RenderSettings::lowestTier
};

struct GatherConstants {  // pushed
  uvec2 extent;           // of the image as it is drawn
  uvec2 voteExtent;
  uvec2 tile;        // of the atlas
  uint view;         // index into GatherView[]
  float depthFirst;  // canvas depth = depthFirst + depthSpan · (1 − nearDistance · ρ)
  float depthSpan;
};

/// Trust in a hypothesis that `confirmations` other photographs confirm.
IBR_FUNCTION float gatherTrust(int confirmations) {
  return confirmations >= 3 ? 1.0f : confirmations == 2 ? 0.7f : confirmations == 1 ? 0.25f : 0.06f;
}

/// ρ by which two hypotheses may differ and still be the same surface.
IBR_FUNCTION float gatherTolerance(float step, float inverseDepth) {
  return kGatherSteps * step + kGatherShare * inverseDepth;
}

/// How much a hypothesis at `there` supports one at `here`, 0 to 1.
IBR_FUNCTION float gatherKernel(float here, float there, float step) {
  const float off = (here - there) / gatherTolerance(step, here);
  return max(0.0f, 1.0f - off * off);
}

/// Share of itself by which the ρ of a surface may be off.
IBR_FUNCTION float gatherUncertainty(float consensus) {
  return kGatherUnsure * max(0.0f, 1.0f - consensus / kGatherSureConsensus);
}

/// One standard deviation of a pixel's ρ; what was completed or filled may be anywhere. `spread`: of the vote's
/// hypotheses about it, a share of ρ; `variance`: of the photographs' colours, 8-bit levels².
IBR_FUNCTION float gatherSigma(int tier, float inverseDepth, float step, float spread, float variance) {
  if (tier != 0) return inverseDepth;
  const float colours = min(sqrt(variance) / kGatherColourSpread, kGatherMostColours);
  const float apart = kGatherSpreadDeviation * (1.0f + kGatherColourDeviation * colours) * spread * inverseDepth;
  const float sure = kGatherStepDeviation * step;
  return sqrt(sure * sure + apart * apart);
}

/// Last channel of the vote's image, a whole number: 0 in holes. Completed: most of a surface's weight comes from depth
/// that nobody confirmed. `consensus`: 0 to 1, is kept in 255 steps. `spread`: 0 to 1, of all hypotheses about the
/// nearest surface that hides at least half; less than the least level is 0.
IBR_FUNCTION float gatherCode(bool completed0, float consensus0, bool completed1, float consensus1, float spread) {
  const float level = kGatherSpreadLevels + kGatherSpreadOctave * log2(max(spread, 1e-9f));
  return 1.0f + (completed0 ? 2.0f : 0.0f) + (completed1 ? 4.0f : 0.0f) + 8.0f * floor(255.0f * consensus0 + 0.5f) +
         2048.0f * floor(255.0f * consensus1 + 0.5f) +
         524288.0f * clamp(floor(level + 0.5f), 0.0f, kGatherSpreadLevels);
}
IBR_FUNCTION bool gatherIsHole(uint code) {
  return code == 0u;
}
IBR_FUNCTION bool gatherIsCompleted(uint code, int surface) {
  return (code >> (1 + surface) & 1u) != 0u;
}
IBR_FUNCTION float gatherConsensus(uint code, int surface) {
  return float(code >> (3 + 8 * surface) & 255u) / 255.0f;
}
IBR_FUNCTION float gatherSpread(uint code) {
  const float level = float(code >> 19);
  return level > 0.0f ? exp2((level - kGatherSpreadLevels) / kGatherSpreadOctave) : 0.0f;
}

IBR_SHARED_END

#endif
