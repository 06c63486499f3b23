// SPDX-License-Identifier: Apache-2.0
// Depth of matches that were found without it.
#pragma once

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

struct PositionDepth {
  double inverseDepth = 0;  // not negative
  double motion = 0;        // px that a unit of it moves the members, root of the sum of squares; 0: it is not known
};

/// The inverse depth for which the members (`maps` from the frame) see the frame's pixel nearest to `positions`: linear
/// least squares.
PositionDepth positionDepth(std::span<const FrameToMember> maps, glm::dvec2 pixel,
                            std::span<const glm::dvec2> positions);

/// Fills inverseDepth and inverseDepthStep of a match whose frame and positions are known: at each pixel the depth
/// of its positions, a step being what moves the members by 1 px against each other (median). Poses that know no
/// parallax give 0 and a step of 1.
void depthFromPositions(DenseMatch& match, std::span<const Camera> cameras);

}  // namespace ibr
