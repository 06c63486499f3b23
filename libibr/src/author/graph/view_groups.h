// SPDX-License-Identifier: Apache-2.0
// Groups of photographs with similar rotation, one per capture site ([T] §2.4.1).
//
// The group of a photograph contains, from each site, the photograph closest in direction, within θ; all panoramas form
// one group. Groups overlap, since disjoint ones would cut rigs whose direction changes slowly. Groups are used largest
// first, until each photograph is in one together with its neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "author/graph/graph_views.h"

namespace ibr {

using ViewGroup = std::vector<std::uint32_t>;  // ascending

/// Groups of at least two views.
std::vector<ViewGroup> orientationGroups(const Views& views);

/// Splits a group into distant parts, since a distant photograph would decide the rank of all, and adds the pairs that
/// bridge them. A group on a lattice, or one of many small parts, stays whole.
std::vector<ViewGroup> partsOf(const Views& views, const ViewGroup& group);

}  // namespace ibr
