// SPDX-License-Identifier: Apache-2.0
// Propagates planes to unmatched features, triangle by triangle (steps 4 to 6 of homographic decomposition matching).
//
//   local refinement     a match moves to a neighbour's plane if the members are more similar there
//   local extrapolation  a feature without a match is placed by the plane of one of the matches around it
//   focused matching     features that no plane explains are matched by descriptor inside the corresponding triangle
#pragma once

#include <span>
#include <vector>

#include "author/features/features.h"
#include "author/match/plane_patch.h"
#include "author/sweep/plane_maps.h"

namespace ibr {

struct Propagation {
  std::span<const PlaneMaps> planes;
  const PlanePatches& patches;
  std::span<const Features> features;  // of each member
};

void refineLocally(std::vector<PlaneTrack>& tracks, const Propagation& with);

/// Appends tracks for features of the first member without a track. Returns their number.
std::size_t extrapolateLocally(std::vector<PlaneTrack>& tracks, const Propagation& with);
std::size_t matchFocused(std::vector<PlaneTrack>& tracks, const Propagation& with);

}  // namespace ibr
