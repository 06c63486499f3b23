// SPDX-License-Identifier: Apache-2.0
// Photographs of similar rotation, one a spot ([T] §2.4.1).
//
// The group of a photograph are those that look within θ of its direction, the best one of each spot; all panoramas are
// one group. Groups overlap, because disjoint ones cut rigs whose direction changes slowly. Not all are used, which
// would be as many as there are photographs: largest first, until each photograph stands in one with those around it.
#pragma once

#include <cstdint>
#include <vector>

#include "author/graph/graph_views.h"

namespace ibr {

using ViewGroup = std::vector<std::uint32_t>;  // ascending

/// Groups of at least two views.
std::vector<ViewGroup> orientationGroups(const Views& views);

/// A group in parts, where it falls into such: one that stands far off would decide the rank of all. Parts are followed
/// by the pairs that bridge them. A group on a lattice, or one of many small parts, stays whole.
std::vector<ViewGroup> partsOf(const Views& views, const ViewGroup& group);

}  // namespace ibr
