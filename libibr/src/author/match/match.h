// SPDX-License-Identifier: Apache-2.0
// A dense match of 2 to 4 posed photographs ([T] §2.4.1 asks for one; ours has their depth, or is a plane sweep, since
// the poses are known).
//
//   1. mean frame; inverse-depth range from the tracks
//   2. at half resolution, brought to full: the depth that the members have (frame_depth.h); where it is not known,
//      plane sweep by dominant planes from the tracks, and semi-global matching, cleaned, foregrounds trimmed
//   3. gate: inside all members' pictures, alike in all of them, of one depth in all of them if theirs is known, and
//      hidden from none by what stands before it; where a member is masked the others decide
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
  std::span<const MemberDepth> depths = {};  // of the views, in their order; empty: the frame is swept
};

/// `points` of the world that the members see give the sweep its range and planes. Precondition: 2 to 4 views. Throws
/// Error{invalidInput} where no point lies in front of the mean frame.
DenseMatch matchViews(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options = {});

}  // namespace ibr
