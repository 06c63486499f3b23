// SPDX-License-Identifier: Apache-2.0
// Plane sweep: how well the members agree if what the mean frame sees at a pixel has a given depth (Collins 1996; cost
// of Hirschmüller & Scharstein's comparison, PAMI 2009: zero-mean normalised cross-correlation).
//
// Which depths: sweep_levels.h. What each costs: window_correlation.h.
//
// On a surface that is seen along it, as the ground, a window has no one depth. For planes that the scene is known to
// have the sweep therefore also tries depths that change over the picture as the plane's (Gallup et al., CVPR 2007).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/sweep/sweep_levels.h"
#include "author/sweep/window_correlation.h"
#include "ibr/image.h"

namespace ibr {

struct CostVolume {
  int width = 0, height = 0, levels = 0;
  std::vector<std::uint8_t> cost;  // height × width × levels
  ImageF guide;                    // grey of what the members agree on best: the frame's picture, roughly
  std::vector<std::vector<std::int16_t>> planes;  // of each slanted plane: its level at a pixel; kNoLevel: not there
};
inline constexpr std::int16_t kNoLevel = -1;
inline constexpr int kPlaneReach = 2;  // levels before and behind a plane that count as being on it

/// `planes` as of dominantPlanes, in px of `frame`; those that are hardly slanted are left out, as nothing is gained
/// there.
CostVolume planeSweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& levels,
                      std::span<const glm::dvec3> planes = {});

}  // namespace ibr
