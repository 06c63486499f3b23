// SPDX-License-Identifier: Apache-2.0
// Dense match of 2 to 4 posed photographs, which [T] §2.4.1 requires. Since poses are known, the match is the members'
// depth, or a plane sweep.
//
//   1. mean frame; inverse-depth range from the tracks
//   2. at half resolution, then upsampled: the members' depth (frame_depth.h); where unknown, plane sweep by dominant
//      planes from the tracks and semi-global matching, with cleaning and trimmed foregrounds
//   3. gate: inside and alike in all members' images; the same depth in all members, if known; hidden from no member by
//      a nearer surface. Masked members do not count: the others decide
//   4. if poses are estimates: optical flow between members warped to the frame is added to the matches; large flow
//      closes the gate
#pragma once

#include <span>
#include <vector>

#include "author/geometry/match_view.h"
#include "author/match/frame_depth.h"
#include "ibr/author/poses.h"

namespace ibr {

struct MatchOptions {
  bool refine = false;                       // step 4
  std::span<const MemberDepth> depths = {};  // of the views, in their order; empty: the frame is swept
};

/// `points`: world points that the members see; they give the sweep its range and planes. Precondition: 2 to 4 views.
/// Throws Error{invalidInput} if no point lies in front of the mean frame.
DenseMatch matchViews(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options = {});

}  // namespace ibr
