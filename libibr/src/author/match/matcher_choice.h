// SPDX-License-Identifier: Apache-2.0
// Chooses the method that matches a cell's members, and runs it.
#pragma once

#include <span>

#include "author/match/match.h"
#include "ibr/author/build.h"

namespace ibr {

inline constexpr double kMaxSweepErrorPx = 1.0;  // maximum median reprojection error of poses for a plane sweep

/// Returns the median reprojection error of the tracks that at least two members share, each triangulated again, in px
/// of the cameras' images. A track counts with its worst member; infinite without shared tracks. `members`: the
/// cameras' images in the model; `tracks`: indices of the model's tracks that count.
double cellReprojectionError(const PosedModel& model, std::span<const std::uint32_t> members,
                             std::span<const Camera> cameras, std::span<const std::uint32_t> tracks);

/// Resolves `wanted`: `automatic` becomes the sweep if the (adjusted) poses reproject within kMaxSweepErrorPx, else the
/// flow.
MatchMethod resolveMatcher(MatchMethod wanted, double reprojectionPx);

struct CellMatchOptions {
  MatchMethod matcher = MatchMethod::sweep;  // not automatic
  bool posesUsable = true;                   // within kMaxSweepErrorPx …
  bool refine = false;                       // … but not exact
  std::uint64_t seed = 1;
  std::span<const MemberDepth> depths = {};  // as MatchOptions::depths; for the sweep
};

/// Precondition: 2 to 4 views. Throws Error{invalidInput} if the sweep has no point in front of the members.
DenseMatch matchCell(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                     const CellMatchOptions& options);

}  // namespace ibr
