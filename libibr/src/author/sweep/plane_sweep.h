// SPDX-License-Identifier: Apache-2.0
// Plane sweep: how well the members agree at each depth of a pixel of the mean frame (Collins 1996; matching cost:
// zero-mean normalised cross-correlation, Hirschmüller & Scharstein, PAMI 2009).
//
// Depths: sweep_levels.h. Costs: window_correlation.h.
//
// A window on a surface at a grazing angle, as the ground, has no single depth. For known planes of the scene the sweep
// therefore also tries depths that follow the plane across the image (Gallup et al., CVPR 2007).
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
  std::vector<std::uint8_t> cost;                 // height × width × levels
  ImageF guide;                                   // grey values at the best depth: approximately the frame's image
  std::vector<std::vector<std::int16_t>> planes;  // level of each slanted plane at a pixel; kNoLevel: not there
};
inline constexpr std::int16_t kNoLevel = -1;
inline constexpr int kPlaneReach = 2;  // levels in front of and behind a plane that count as the plane's

/// `planes`: as from dominantPlanes, in px of `frame`; planes with little slant are skipped, since they gain nothing.
CostVolume planeSweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& levels,
                      std::span<const glm::dvec3> planes = {});

}  // namespace ibr
