// SPDX-License-Identifier: Apache-2.0
// Points that photographs share, by the dense matches of all cells.
//
//   1. seeds on a grid in each photograph
//   2. each is looked up in every cell that has the photograph: in the nearest triangle of tier 0 over it, whose
//      corners' matches say where the other members see it
//   3. what cells say of the same member must agree; where two are more than 1 px apart, nothing is said of it
// A track is a star: a photograph's point in all that share a cell with it.
#pragma once

#include <vector>

#include "author/poses/bundle_adjust.h"
#include "ibr/scene.h"

namespace ibr {

struct DenseTrackOptions {
  double seeds = 400;    // of a photograph, about
  double agreePx = 1.0;  // px of the stored photographs
};

/// Tracks of the scene's cells, ordered by photograph; pixels in the nodes' cameras. Cells with panoramas say nothing.
std::vector<BundlePoint> denseTracks(const std::vector<Node>& nodes, const std::vector<Cell>& cells,
                                     const DenseTrackOptions& options = {});

}  // namespace ibr
