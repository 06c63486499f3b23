// SPDX-License-Identifier: Apache-2.0
// Depth of matches that were found without depth.
#pragma once

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

struct PositionDepth {
  double inverseDepth = 0;  // not negative
  double motion = 0;        // px per unit of inverse depth, root of the sum of squares over members; 0: depth unknown
};

/// Returns the inverse depth at which the members (`maps` from the frame) see the frame's pixel nearest to `positions`:
/// linear least squares.
PositionDepth positionDepth(std::span<const FrameToMember> maps, glm::dvec2 pixel,
                            std::span<const glm::dvec2> positions);

/// Fills inverseDepth and inverseDepthStep of a match with known frame and positions. A pixel gets the depth of its
/// positions; a step moves the members by 1 px relative to each other (median). Poses without parallax give 0 and a
/// step of 1.
void depthFromPositions(DenseMatch& match, std::span<const Camera> cameras);

}  // namespace ibr
