// SPDX-License-Identifier: Apache-2.0
// Homographic decomposition of matches, after Seibt, von Rymon Lipinski & Latoschik, IEEE Access 2022: repeatedly finds
// and seals the largest set of remaining matches that fit one homography.
//
// Departure: one plane is fitted to all members of a cell together. Samples are drawn from neighbours (NAPSAC, Torr et
// al. 2002), which share a plane more often than distant points, and grown by least squares.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"

namespace ibr {

inline constexpr double kMaxPlaneErrorPx = 1.5;  // maximum distance of a match from its homography's prediction, px
inline constexpr std::size_t kMaxPlanes = 400;   // of a cell

/// Minimum number of matches on a plane: three times the minimum that determines one.
inline std::size_t minOnPlane(const PlaneFitter& fit) {
  return 3 * fit.minTracks();
}

/// Finds the largest plane among the tracks whose `plane` is −1, appends it and sets their `plane`; returns true if one
/// was found. Deterministic for equal tracks and seed.
bool sealLargestPlane(const PlaneFitter& fit, std::span<PlaneTrack> tracks, std::vector<PlaneMaps>& planes,
                      std::uint64_t seed);

}  // namespace ibr
