// SPDX-License-Identifier: Apache-2.0
// Swept depth to a fraction of a level, in finer pictures than the sweep's (after PatchMatch Stereo: Bleyer, Rhemann &
// Rother, BMVC 2011).
//
//   Each pixel of the depth has a plane. Its cost is the mean over the better two thirds of at most five sources of
//   1 − ZNCC of 5×5 samples, two px of the fine picture apart, weighted by exp(−|difference to the middle one| / 25).
//   The sources are those that agree best with the depth as it was swept.
//   Three scans, there and back: the planes of the two neighbours that were visited before, continued; the own one
//   moved by ± .35, .18, .09 of a level; one of another slope. A plane is taken that costs less by kLeastGain. Where
//   the mean cost of 5×5 pixels stays above kMostCost the depth remains as it was.
#pragma once

#include <span>

#include "author/depth/photograph_sweep.h"

namespace ibr {

/// Refines depth.inverseDepth but for the sky and what is unknown. `photograph` and `sources`: those that the depth was
/// swept with, at any size, twice the depth's for example; the sources' masks are 0 where nothing is to be read.
/// Does not depend on threads: the same bytes always.
void refineDepth(SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources);
/// Memory that it takes beside the pictures.
inline constexpr double kRefinedBytesPerPixel = 40;

}  // namespace ibr
