// SPDX-License-Identifier: Apache-2.0
// Depth of a cell's mean frame from the depth of its members.
//
//   layer   a member's depth map as a surface, cut at depth jumps and drawn into the frame: its nearest part
//   vote    a pixel's layers support each other; its depth is the mean of those around the best supported one
//   agree   the members whose layer has that depth
#pragma once

#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// A member's reliable depth. `camera` has the map's size. ρ is along the axis for a pinhole, along the ray for a
/// panorama.
struct MemberDepth {
  Camera camera;
  ImageF inverseDepth;  // 1 / world unit; 0 in the sky; negative if unknown
  double step = 0;      // ρ; neighbours on one surface differ by at most two of these
};

/// One channel each, of the frame's size.
struct FrameDepth {
  ImageF inverseDepth;  // along the frame's axis; if unknown, the farther one of the nearest known left and right
  Image8 agree;         // bit i: member i has that depth
};

/// `frame`: a pinhole. `step`: ρ of one level of a plane sweep; depths within two of these plus 1 % count as equal.
/// Pure. Throws Error{invalidInput} for more than kMaxMembers (author/geometry/match_view.h).
FrameDepth depthOfFrame(const Camera& frame, std::span<const MemberDepth> members, double step);

}  // namespace ibr
