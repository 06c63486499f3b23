// SPDX-License-Identifier: Apache-2.0
// A dense match of 2 to 4 posed photographs ([T] §2.4.1 asks for one; ours is a plane sweep, since the poses are
// known).
//
//   1. mean frame; inverse-depth range and dominant planes from the tracks
//   2. plane sweep and semi-global matching at half resolution, cleaned, foregrounds trimmed, brought to full
//   resolution
//      or, where the members' depth is known, that of the frame from it (frame_depth.h)
//   3. gate: of that depth in all members, if so; inside all members' pictures, alike in all of them, and hidden from
//   none by what stands before it
//   4. where the poses are estimates: what optical flow finds between the members, warped to the frame, is added to the
//      matches; too large a flow shuts the gate
#pragma once

#include <span>
#include <vector>

#include "author/geometry/match_view.h"
#include "author/match/frame_depth.h"
#include "ibr/author.h"

namespace ibr {

struct MatchOptions {
  bool refine = false;                       // step 4
  std::span<const MemberDepth> depths = {};  // of the views; empty: step 2 finds the frame's
};

/// `points` of the world that the members see give the sweep its range and planes. Precondition: 2 to 4 views. Throws
/// Error{invalidInput} where no point lies in front of the mean frame.
DenseMatch matchViews(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options = {});

}  // namespace ibr
