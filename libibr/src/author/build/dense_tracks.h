// SPDX-License-Identifier: Apache-2.0
// Tracks that photographs share, from the dense matches of all cells.
//
//   1. places seeds on a grid in each photograph
//   2. looks each seed up in every cell of the photograph: the nearest triangle of tier 0 over the seed gives its
//      pixels in the other members by interpolation
//   3. averages what the cells give for a member; drops the member if two differ by more than agreePx
// A track is a star: a point of one photograph, seen by all photographs that share a cell with it.
#pragma once

#include <vector>

#include "author/poses/bundle_adjust.h"
#include "ibr/scene.h"

namespace ibr {

struct DenseTrackOptions {
  double seeds = 400;    // seeds per photograph, approximate
  double agreePx = 1.0;  // px of the stored photographs
};

/// Tracks of the scene's cells, ordered by photograph; pixels in the nodes' cameras. Skips cells with panoramas.
std::vector<BundlePoint> denseTracks(const std::vector<Node>& nodes, const std::vector<Cell>& cells,
                                     const DenseTrackOptions& options = {});

}  // namespace ibr
