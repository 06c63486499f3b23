// SPDX-License-Identifier: Apache-2.0
// Which photographs to take next: greedily, those that add most to a walk's estimate.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/advice.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {

/// At most `count`, best first; each is counted as taken in `walk`. Candidates are turned and zoomed as photographs
/// that there are:
///   between neighbours, halfway and by thirds; at a place, as a neighbour looks; at the corners that a grid lacks;
///   beside a row.
/// None whose gain is below `leastGain` (of one stand), and none where another one or a photograph looks the same way.
std::vector<NextView> nextViews(const Scene& scene, const Places& places, WalkEstimate& walk, std::size_t count,
                                double leastGain);

}  // namespace ibr
