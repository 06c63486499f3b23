// SPDX-License-Identifier: Apache-2.0
// Which pixels of the mean frame a member can see, given their depth.
#pragma once

#include "author/geometry/mean_frame.h"
#include "ibr/image.h"

namespace ibr {

/// One channel, the frame's size: 1 where the member sees the point of a pixel. The points of pixels that are `solid`
/// (1 channel) are splatted into the member (3×3 pixels each); a point is hidden where one of them is nearer there by
/// more than `tolerance` (inverse depth), and unseen where it falls outside the member's picture.
Image8 visibleFrom(const FrameToMember& map, const ImageF& inverseDepth, const Image8& solid, int memberWidth,
                   int memberHeight, float tolerance);

}  // namespace ibr
