// SPDX-License-Identifier: Apache-2.0
// How unlike a photograph's patch and what another photograph shows of a slanted plane are: 1 − ZNCC of 5×5 samples,
// two px apart, weighted by exp(−|difference to the middle one| / 25) (after PatchMatch Stereo: Bleyer, Rhemann &
// Rother, BMVC 2011).
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

inline constexpr int kPatchSide = 5, kPatchApart = 2;  // samples along a side, and px from one to the next
inline constexpr std::size_t kPatchSamples = std::size_t(kPatchSide) * kPatchSide;
inline constexpr std::size_t kLanes = 8, kPaddedSamples = (kPatchSamples + kLanes - 1) / kLanes * kLanes;
inline constexpr float kUnseenPatch = 2;  // cost where a source does not see the patch in full

struct DepthPlane {
  float inverseDepth;  // at a point of the picture
  glm::vec2 slope;     // its change a px
};

/// Samples about the pixel that holds a point of the picture.
struct Patch {
  glm::vec2 middle;                                // of that pixel
  glm::vec2 off;                                   // from the point
  std::array<float, kPaddedSamples> weight, from;  // sum 1; weight · difference from the mean; 0 beyond the samples
  float variance;
};
Patch patchAt(const ImageF& grey, glm::vec2 point);

struct PatchSource {
  glm::mat3 a;  // as FrameToMember
  glm::vec3 b;
  const SweepView* view;  // its mask is 0 where nothing is to be read
};
std::vector<PatchSource> patchSources(const Camera& photograph, std::span<const SweepView> sources);

/// 0 to 2. `plane`: at the patch's point.
float patchCost(const PatchSource& source, const Patch& patch, const DepthPlane& plane);

}  // namespace ibr
