// SPDX-License-Identifier: Apache-2.0
// Where surfaces end in a swept depth map. A window that holds a silhouette agrees best at the foreground's depth,
// wherever its centre lies, so foregrounds come out wider than they are.
#pragma once

#include <span>

#include "author/sweep/plane_sweep.h"

namespace ibr {

/// Gives pixels before a depth edge to the surface behind, in place, from the edge inwards and four pixels at most:
/// where that surface explains the pixel as well as the foreground does and no edge of the picture lies between, or
/// where it explains it clearly better. Explained well: members differ little over a window, whose pixels weigh as
/// their colour is like the pixel's (Yoon & Kweon 2006); of three or more members the odd one does not count, since it
/// may see the foreground. `level` is of `range`, in the frame's pixels as `guide` is. Precondition: kMostMembers views
/// at most.
void trimForegrounds(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range,
                     const ImageF& guide, ImageF& level);

}  // namespace ibr
