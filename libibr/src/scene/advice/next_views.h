// SPDX-License-Identifier: Apache-2.0
// Chooses the next-best views: greedily, the photographs that add most to a walk's estimate.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/advice.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {

/// Returns at most `count` views, best first; each is added to `walk`. Candidates have orientation and zoom of existing
/// photographs:
///   between neighbours, halfway and by thirds; at a capture site, in a neighbour's direction; at missing corners of
///   a grid; beside a row.
/// Skips views with a gain below `minGain` (of one viewpoint), and views close to a photograph or view in direction.
std::vector<NextView> nextViews(const Scene& scene, const SiteGraph& sites, WalkEstimate& walk, std::size_t count,
                                double minGain);

}  // namespace ibr
