// SPDX-License-Identifier: Apache-2.0
// From planes on to what was not matched, triangle by triangle (steps 4 to 6 of homographic decomposition matching).
//
//   local refinement     a match moves to where a neighbour's plane puts it if the members look more alike there
//   local extrapolation  a feature without a match goes where the plane of one of the matches around it puts it
//   focused matching     what no plane explains is sought by descriptor within the corresponding triangle only
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

/// Appends tracks for features of the first member that have none. Returns how many.
std::size_t extrapolateLocally(std::vector<PlaneTrack>& tracks, const Propagation& with);
std::size_t matchFocused(std::vector<PlaneTrack>& tracks, const Propagation& with);

}  // namespace ibr
