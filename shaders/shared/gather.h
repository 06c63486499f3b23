// SPDX-License-Identifier: Apache-2.0
// Composition::gathered: votes for depth, then gathers colours from photographs that see the surface. For GLSL and C++.
//
//   layers   the mesh of every candidate photograph is drawn into a tile of an atlas: ρ, trust, consensus
//   vote     the hypotheses of a pixel support each other. The presence of each is its share of the largest support,
//            times max(1 − kernel / .25, 0) for each hypothesis of more support. From front to back, a hypothesis
//            shows presence · opacity of the rest. The two that show most are the pixel's surfaces
//   gather   a surface's colour is the mean of the N photographs that see the surface best. Each is read at the mip
//            level of the shift that uncertain depth causes: angle · uncertainty / ρ, with the angle between the view's
//            ray and the photograph's. A photograph's own surface hides another only if their depths clearly differ
//
// All lengths are in units of b, the median spacing of the capture sites; ρ is 1 / length.
#ifndef IBR_SHARED_GATHER_H
#define IBR_SHARED_GATHER_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kMaxGathered = 16;       // candidate photographs
IBR_CONSTANT int kMaxGatheredColours = 8;  // photographs of a pixel's colour
IBR_CONSTANT int kGatherColumns = 4;       // tiles per row of the atlas
IBR_CONSTANT int kGatherGroup = 8;         // threads of a workgroup, per dimension
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

// Tuned constants of the method; a change of ±50 % in any of them changes the image by .05 dB.
IBR_CONSTANT float kGatherNear = 0.01f;           // nearest distance that the atlas's depth test resolves, b
IBR_CONSTANT float kGatherNearness = 0.3f;        // of a vote's weight: trust / (kGatherNearness + (d / b)²)
IBR_CONSTANT float kGatherAngleFloor = 0.03f;     // radians, added to every angle
IBR_CONSTANT float kGatherDistanceCost = 0.001f;  // radians per b of distance
IBR_CONSTANT float kGatherBorder = 0.04f;         // share of the photograph's width; weights fade over it at the border
IBR_CONSTANT float kGatherMaxResolution = 1.5f;   // relative to the view's: a finer photograph is no better
IBR_CONSTANT float kGatherHidden = 0.002f;        // minimum visibility: a hidden photograph is better than none
IBR_CONSTANT float kGatherBehind = 0.25f;         // visibility if the photograph's own surface is behind
IBR_CONSTANT float kGatherOwnPoseCost = 0.01f;       // radians of cost below which hiding and borders cease to count
IBR_CONSTANT float kGatherMinApart = 1e-6f;
IBR_CONSTANT float kGatherSameSurface = 0.25f;  // kernel from which on the lesser hypothesis is not a surface
IBR_CONSTANT float kGatherFullConsensus = 0.9f;  // consensus from which on a present surface is opaque
IBR_CONSTANT float kGatherColourSpread = 15.0f;  // 8-bit levels; a surface whose colours deviate so has half the weight
IBR_CONSTANT float kGatherSteps = 2.0f;          // tolerance of the vote: steps …
IBR_CONSTANT float kGatherShare = 0.01f;         // … plus a share of ρ
// Standard deviation of a confirmed ρ: root of the sum of squares of a part in steps, and of a part from the spread of
// the vote. Fitted to the exact depth of a street: 68 % of the errors within one deviation, 95 % within two.
IBR_CONSTANT float kGatherStepDeviation = 0.18f;    // steps
IBR_CONSTANT float kGatherSpreadDeviation = 0.85f;  // of the spread …
IBR_CONSTANT float kGatherColourDeviation = 4.0f;   // … times 1 + this × the colours' deviation / kGatherColourSpread …
IBR_CONSTANT float kGatherMaxColourFactor = 2.0f;       // … of which at most this counts
IBR_CONSTANT float kGatherAloneSpread = 0.05f;      // spread of a hypothesis if it is the only one at the pixel
IBR_CONSTANT float kGatherSpreadLevels = 31.0f;     // largest code: spread 1; kGatherSpreadOctave codes per factor of 2
IBR_CONSTANT float kGatherSpreadOctave = 3.0f;
IBR_CONSTANT float kGatherCompleted = 0.155f;    // trust below which a hypothesis is completed, not matched
IBR_CONSTANT float kGatherExactConsensus = 0.5f;  // consensus from which on ρ counts as exact; below …
IBR_CONSTANT float kGatherMaxRelativeError = 0.1f;         // … its standard deviation is up to this share of ρ
IBR_CONSTANT float kGatherOcclusionSigmas = 3.0f;   // nothing is hidden within so many deviations of both surfaces

/// A photograph's parameters for one view. Photograph axes: axes of its camera.
struct GatherCandidate {
  mat3 toView;  // photograph axes → view axes
  vec3 place;   // position of the photograph relative to the view, view axes
  mat3 toPhotograph;
  vec3 shift;      // of the view relative to the photograph, photograph axes
  vec2 focal;      // in widths and heights; unused for a panorama
  vec2 principal;  // in widths and heights
  float aspect;    // height / width
  float focalPx;   // px per radian in the middle
  float weight;    // of all the photograph's contributions, 0 to 1
  float voteWeight;    // weight / (kGatherNearness + d²)
  float distanceCost;  // radians
  float step;          // change of ρ that moves a point by 2 px over a baseline of b
  float residual;      // change of ρ that moves a point by the reprojection residual over b
  float depthScale;    // ρ of a red value of 1 in the depth texture
  uint slot;           // slot of its texture array, and layer in the array
  uint layer;
  uint depthSlot;  // the same for its depth texture
  uint depthLayer;
  uint panorama;  // 1: a panorama
  vec3 gain;      // of linear light
  vec3 slope;     // gain^(1 / 2.4)
};

struct GatherView {
  GatherCandidate candidate[kMaxGathered];
  vec4 projection;  // as CellParameters::projection
  vec4 toRay;       // ray.xy = toRay.xy · pixel + toRay.zw, for pixels of the image as it is drawn; ray.z = −1
  float spacing;    // b, world units
  float step;       // median of the candidates' steps
  float focalPx;    // px per radian in the middle of the image as it is drawn
  float detail;     // as CellParameters::detail
  float nearDistance;  // FramePlan::nearDistance, b
  uint count;          // number of candidates
  int maxTier;      // RenderSettings::maxTier
};

struct GatherConstants {  // push constants
  uvec2 extent;           // of the image as it is drawn
  uvec2 voteExtent;
  uvec2 tile;        // extent of a tile of the atlas
  uint view;         // index into GatherView[]
  float depthFirst;  // canvas depth = depthFirst + depthSpan · (1 − nearDistance · ρ)
  float depthSpan;
};

/// Returns the trust in a hypothesis that `confirmations` other photographs confirm.
IBR_FUNCTION float gatherTrust(int confirmations) {
  return confirmations >= 3 ? 1.0f : confirmations == 2 ? 0.7f : confirmations == 1 ? 0.25f : 0.06f;
}

/// Returns the difference of ρ within which two hypotheses are the same surface.
IBR_FUNCTION float gatherTolerance(float step, float inverseDepth) {
  return kGatherSteps * step + kGatherShare * inverseDepth;
}

/// Returns the support of a hypothesis at `there` for one at `here`, 0 to 1.
IBR_FUNCTION float gatherKernel(float here, float there, float step) {
  const float off = (here - there) / gatherTolerance(step, here);
  return max(0.0f, 1.0f - off * off);
}

/// Returns the uncertainty of a surface's ρ, as a share of ρ.
IBR_FUNCTION float gatherUncertainty(float consensus) {
  return kGatherMaxRelativeError * max(0.0f, 1.0f - consensus / kGatherExactConsensus);
}

/// Returns one standard deviation of a pixel's ρ: all of ρ for completed and filled depth. `spread`: of the vote's
/// hypotheses about the surface, a share of ρ. `variance`: of the photographs' colours, 8-bit levels².
IBR_FUNCTION float gatherSigma(int tier, float inverseDepth, float step, float spread, float variance) {
  if (tier != 0) return inverseDepth;
  const float colours = min(sqrt(variance) / kGatherColourSpread, kGatherMaxColourFactor);
  const float apart = kGatherSpreadDeviation * (1.0f + kGatherColourDeviation * colours) * spread * inverseDepth;
  const float sure = kGatherStepDeviation * step;
  return sqrt(sure * sure + apart * apart);
}

/// Returns the last channel of the vote's image, an integer; 0 marks a hole. Completed: most of a surface's weight is
/// from unconfirmed depth. `consensus`: 0 to 1, stored in 255 steps. `spread`: 0 to 1, of all hypotheses, about the
/// nearest surface that hides at least half; values below the smallest level become 0.
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
