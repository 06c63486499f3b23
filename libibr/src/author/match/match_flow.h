// SPDX-License-Identifier: Apache-2.0
// A dense match of 2 to 4 photographs whose poses are not to be relied on.
//
//   1. between every two, both ways: sparse features; the map they say (mesh_warp.h); optical flow (Kroeger et al.
//   2016)
//      from the one to the other as that map shows it, added to the map; and once more
//   2. gate: there and back again ends where it began; by way of a third member it is the same; alike in all
//   3. depths that the poses, such as they are, give to the matches
#pragma once

#include "author/match/match.h"

namespace ibr {

/// The frame is member 0's camera: without poses there is no mean one. `refined` is set. Precondition: 2 to 4 views.
/// Pictures without texture in common give a match that is good nowhere.
DenseMatch matchByFlow(std::span<const MatchView> views);

}  // namespace ibr
