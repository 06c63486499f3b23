// SPDX-License-Identifier: Apache-2.0
// Splits the positions of a group of photographs into simplices.
//
// On a lattice, by lattice.h. Otherwise by a Delaunay triangulation of the rank of the positions (line, plane or space
// by their spread): in full rank, noise would turn a plane into slivers.
#pragma once

#include <vector>

#include "author/geometry/simplex.h"
#include "author/graph/graph_views.h"
#include "author/graph/view_groups.h"

namespace ibr {

struct GroupSplit {
  std::vector<Simplex> simplices;  // of views, each ascending, all sorted; all of one size, empty for one position
  bool overlaps = false;           // simplices are faces of larger ones, and may overlap
};

/// `maxMembers`: 2 to 4. If the positions span larger simplices, their faces (or edges) are used: on a lattice those
/// along its axes, otherwise those of each simplex that are about as small as its smallest one. Every position stays in
/// a simplex.
GroupSplit splitGroup(const Views& views, const ViewGroup& group, std::size_t maxMembers);

/// Min shape (simplex.h) of a cell with this number of members.
double minShape(std::size_t members);

}  // namespace ibr
