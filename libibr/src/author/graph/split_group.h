// SPDX-License-Identifier: Apache-2.0
// The simplices that the places of a group of photographs are split into.
//
// On a lattice, the lattice's (lattice.h). Else their rank is line, plane or space, by the spread of the places, and
// Delaunay's triangulation of that rank: without it noise would make slivers of a plane.
#pragma once

#include <vector>

#include "author/geometry/simplex.h"
#include "author/graph/graph_views.h"
#include "author/graph/view_groups.h"

namespace ibr {

struct GroupSplit {
  std::vector<Simplex> simplices;  // of views, each ascending, all sorted; all of one size, empty for a single place
  bool overlaps = false;           // they are faces of larger simplices, and may lie across each other
};

/// `mostMembers` 2 to 4: where the places span more, faces (or edges) of their simplices come instead: on a lattice
/// those along its axes; else of each simplex those whose size is like that of its smallest; no place is left without
/// one.
GroupSplit splitGroup(const Views& views, const ViewGroup& group, std::size_t mostMembers);

/// Least shape (simplex.h) of a cell with as many members.
double leastShape(std::size_t members);

}  // namespace ibr
