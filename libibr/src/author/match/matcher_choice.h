// SPDX-License-Identifier: Apache-2.0
// Which way a cell's members are matched, and matching them that way.
#pragma once

#include <span>

#include "author/match/match.h"
#include "ibr/author.h"

namespace ibr {

inline constexpr double kUsablePx = 1.0;  // median reprojection error up to which a plane sweep can follow poses

/// Median distance between where `cameras` see the tracks that two of them share, placed where they fit best, and where
/// these were observed, px of the cameras' pictures (the worst member's); infinite where they share none. `members`:
/// the cameras' images in the model; `tracks`: of the model, those that count.
double cellReprojectionError(const PosedModel& model, std::span<const std::uint32_t> members,
                             std::span<const Camera> cameras, std::span<const std::uint32_t> tracks);

/// What `wanted` comes to: `automatic` is the sweep where the poses, as adjusted, reproject to kUsablePx, else the
/// flow.
MatchMethod chosenMatcher(MatchMethod wanted, double reprojectionPx);

struct CellMatchOptions {
  MatchMethod matcher = MatchMethod::sweep;  // not automatic
  bool posesUsable = true;                   // to kUsablePx …
  bool refine = false;                       // … but not exact
  std::uint64_t seed = 1;
  std::span<const MemberDepth> depths = {};  // as MatchOptions::depths; for the sweep
};

/// Precondition: 2 to 4 views. Throws Error{invalidInput} where the sweep has no point in front of the members.
DenseMatch matchCell(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                     const CellMatchOptions& options);

}  // namespace ibr
