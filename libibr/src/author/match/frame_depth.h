// SPDX-License-Identifier: Apache-2.0
// Depth of a cell's mean frame from the depth of its members.
//
//   layer   a member's depth map as a surface, cut where it jumps, as the frame sees it: its nearest part
//   vote    the layers of a pixel support each other; the pixel has the mean depth of those around the best supported
//   agree   which members have it
#pragma once

#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// A member's depth, as far as it is believed. `camera` has the map's size; a pinhole's ρ is along its axis, that of a
/// panorama along the ray.
struct MemberDepth {
  Camera camera;
  ImageF inverseDepth;  // 1 / world unit; 0 in the sky; negative where unknown
  double step = 0;      // between neighbours of one surface ρ differs by two of these at most
};

/// One channel each, of the frame's size.
struct FrameDepth {
  ImageF inverseDepth;  // along the frame's axis; beyond what any member knows, what is farther to the left or right
  Image8 agree;         // bit i: member i has that depth
};

/// `frame`: a pinhole. `step`: ρ that a level of a plane sweep would have; depths that differ by two of these and 1 %
/// are one. Pure. Throws Error{invalidInput} for more than kMostMembers (author/geometry/match_view.h).
FrameDepth depthOfFrame(const Camera& frame, std::span<const MemberDepth> members, double step);

}  // namespace ibr
