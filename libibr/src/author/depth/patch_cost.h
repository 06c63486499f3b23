// SPDX-License-Identifier: Apache-2.0
// Dissimilarity of a photograph's patch and another photograph's view of a slanted plane: 1 − ZNCC of 5×5 samples, 2 px
// apart, weighted by exp(−|difference from the middle sample| / 25) (after PatchMatch Stereo: Bleyer, Rhemann & Rother,
// BMVC 2011).
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/sweep/window_correlation.h"

namespace ibr {

inline constexpr int kPatchSide = 5, kPatchSpacing = 2;  // samples per side, and their distance in px
inline constexpr std::size_t kPatchSamples = std::size_t(kPatchSide) * kPatchSide;
inline constexpr std::size_t kLanes = 8, kPaddedSamples = (kPatchSamples + kLanes - 1) / kLanes * kLanes;
inline constexpr float kUnseenPatchCost = 2;  // cost where a source does not see the whole patch

struct DepthPlane {
  float inverseDepth;  // at a point of the image, 1 / world unit
  glm::vec2 slope;     // change of inverse depth per px
};

/// Samples around the pixel that contains a point of the image.
struct Patch {
  glm::vec2 middle;                                // of that pixel
  glm::vec2 off;                                   // from the point to the middle
  std::array<float, kPaddedSamples> weight, from;  // sum 1; weight · difference from the mean; 0 beyond the samples
  float variance;
};
Patch patchAt(const ImageF& grey, glm::vec2 point);

struct PatchSource {
  glm::mat3 a;  // as in FrameToMember
  glm::vec3 b;
  const SweepView* view;  // its mask is 0 where pixels must not be read
};
std::vector<PatchSource> patchSources(const Camera& photograph, std::span<const SweepView> sources);

/// Cost of a plane, 0 to 2. `plane`: at the patch's point.
float patchCost(const PatchSource& source, const Patch& patch, const DepthPlane& plane);

}  // namespace ibr
