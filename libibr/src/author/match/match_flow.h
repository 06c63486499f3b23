// SPDX-License-Identifier: Apache-2.0
// Dense match of 2 to 4 photographs whose poses are unreliable.
//
//   1. for each pair of photographs, both ways: sparse features; the map that these features define (mesh_warp.h);
//      optical flow (Kroeger et al. 2016) between the one and the other warped by the map, added to the map; two rounds
//      of flow in all, the second one on the map of the first
//   2. gate: consistent forward and backward, and through a third member; alike in all members
//   3. depth of the matches by the inaccurate poses
#pragma once

#include "author/match/match.h"

namespace ibr {

/// The frame is member 0's camera: without reliable poses there is no mean frame. `refined` is set. Precondition: 2 to
/// 4 views. Images that share no texture give a match that is good nowhere.
DenseMatch matchByFlow(std::span<const MatchView> views);

}  // namespace ibr
