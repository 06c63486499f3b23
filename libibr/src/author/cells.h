// SPDX-License-Identifier: Apache-2.0
// Which photographs make a morphing cell ([T] §2.4.1: nodes of similar rotation that span a simplex).
//
//   1. spots: photographs from one place (spots.h)
//   2. groups: for each photograph those that look within θ of its direction, the best one of each spot; groups
//      overlap, because disjoint ones cut rigs whose direction changes slowly; all panoramas are one group
//   3. rank of a group: line, plane or space, by the spread of its places; Delaunay in that rank
//   4. a simplex becomes a cell if its axes agree within θ, it is no sliver and every pair of members shares enough
//      tracks, where there are any; else its faces may, else its edges
//   5. drop what another cell of the group covers
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/author.h"

namespace ibr {

struct CellPlan {
  std::vector<std::vector<std::uint32_t>> cells;  // indices into PosedModel::images, each cell sorted by name
  std::vector<BuildReport::Dropped> dropped;      // simplices that were refused, and photographs that are in no cell
  bool ordered = false;                           // several photographs were taken from each spot ([T] §2.4.2)
};

/// Uses `dimension` and `thetaDegrees` of the options. The cells do not depend on the order of images or tracks.
CellPlan planCells(const PosedModel& model, const BuildOptions& options);

}  // namespace ibr
