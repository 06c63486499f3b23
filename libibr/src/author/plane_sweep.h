// SPDX-License-Identifier: Apache-2.0
// Plane sweep: how well the members agree if what the mean frame sees at a pixel has a given depth (Collins 1996; cost
// of Hirschmüller & Scharstein's comparison, PAMI 2009: zero-mean normalised cross-correlation).
//
//   levels of inverse depth, spaced so that one step moves the members by about one pixel against each other
//   cost(pixel, level) = mean over pairs of members of 1 − ZNCC of 5×5 windows, 0 … kCostLargest; more at near levels
//                        where the windows have no texture
//
// On a surface that is seen along it, as the ground, a window has no one depth. For planes that the scene is known to
// have the sweep therefore also tries depths that change over the picture as the plane's (Gallup et al., CVPR 2007).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/mean_frame.h"
#include "ibr/image.h"

namespace ibr {

/// The depths that are tried, as inverse depths along the frame's axis: from 0 (infinity) upwards.
struct SweepLevels {
  std::vector<double> inverseDepth;  // ascending
  double step = 0;                   // between levels among the tracks; towards infinity the steps grow
  double evenFrom = 0;               // inverse depth from which on they do not

  int count() const { return int(inverseDepth.size()); }
  /// Between levels by linear interpolation. Precondition: 0 <= level <= count() − 1.
  double at(double level) const;
};

/// Levels from infinity to well before the nearest tracks. Precondition: a track's inverse depth at least, all
/// positive.
SweepLevels sweepLevels(const Camera& frame, std::span<const Camera> members, std::vector<double> trackInverseDepths);

/// A member's grey picture in the sweep's resolution, 0 … 255.
struct SweepView {
  Camera camera;
  ImageF grey;
};

inline constexpr int kCostLargest = 240;  // perfectly opposite; 120: no correlation, no texture

struct CostVolume {
  int width = 0, height = 0, levels = 0;
  std::vector<std::uint8_t> cost;  // height × width × levels
  ImageF guide;                    // grey of what the members agree on best: the frame's picture, roughly
  std::vector<std::vector<std::int16_t>> planes;  // of each slanted plane: its level at a pixel; kNoLevel: not there
};
inline constexpr std::int16_t kNoLevel = -1;
inline constexpr int kPlaneReach = 2;  // levels before and behind a plane that count as being on it

/// `planes` as of dominantPlanes; those that are hardly slanted are left out, as nothing is gained there.
CostVolume planeSweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& levels,
                      std::span<const glm::dvec3> planes = {});

}  // namespace ibr
