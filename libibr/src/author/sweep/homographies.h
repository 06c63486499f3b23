// SPDX-License-Identifier: Apache-2.0
// Homographic decomposition of matches, after what is known of Seibt, von Rymon Lipinski & Latoschik, IEEE Access 2022:
// the largest set of matches that obey one homography is found and sealed, then the largest of the rest, and so on.
//
// Ours finds one plane for all members of a cell at once. Samples are drawn from neighbours (NAPSAC, Torr et al. 2002),
// of which a plane is more likely than of places far apart, and grown by least squares.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"

namespace ibr {

inline constexpr double kOnPlanePx = 1.5;        // from where a homography puts a match to where it is
inline constexpr std::size_t kMostPlanes = 400;  // of a cell

/// Matches that make a plane: three times those that fix one.
inline std::size_t leastOnPlane(const PlaneFitter& fit) {
  return 3 * fit.leastTracks();
}

/// Looks for the largest plane among the tracks whose `plane` is −1, appends it and sets theirs; returns whether there
/// was one. The same tracks and seed give the same plane.
bool sealLargestPlane(const PlaneFitter& fit, std::span<PlaneTrack> tracks, std::vector<PlaneMaps>& planes,
                      std::uint64_t seed);

}  // namespace ibr
