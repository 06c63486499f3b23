// SPDX-License-Identifier: Apache-2.0
// Determines which pixels of the mean frame a member sees, given their depth.
#pragma once

#include "author/geometry/mean_frame.h"
#include "ibr/image.h"

namespace ibr {

/// One channel, the frame's size: 1 where the member sees a pixel's point. The points of `solid` pixels (1 channel) are
/// splatted into the member (3×3 pixels each). A point is hidden if a splat there is nearer by more than `tolerance`
/// (inverse depth), and unseen if it falls outside the member's image.
Image8 visibleFrom(const FrameToMember& map, const ImageF& inverseDepth, const Image8& solid, int memberWidth,
                   int memberHeight, float tolerance);

}  // namespace ibr
