// SPDX-License-Identifier: Apache-2.0
// Chooses the next-best views: greedily, the photographs that add most to a walk's estimate.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/advice.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {

/// Returns at most `count` views, best first; each is added to `walk`. Candidates have the orientation and intrinsics
/// of existing photographs:
///   between neighbours, halfway and by thirds; at a capture site, in a neighbour's direction; at missing corners of
///   a grid; beside a row.
/// Skips views with a gain below `minGain` (of one viewpoint), and views that are close in position and direction to a
/// photograph or to a view chosen before.
std::vector<NextView> nextViews(const Scene& scene, const SiteGraph& sites, WalkEstimate& walk, std::size_t count,
                                double minGain);

}  // namespace ibr
