// SPDX-License-Identifier: Apache-2.0
// A match of 2 to 4 photographs by homographic decomposition, [T]'s reference 25 (Seibt, von Rymon Lipinski &
// Latoschik, Dense Feature Matching Based on Homographic Decomposition, IEEE Access 2022), as far as it is known.
//
//   1. features everywhere (features.h)
//   2. match, find the largest plane, seal its matches, and so on (homographies.h); without poses match the rest again
//   3. drop what the neighbours on the Delaunay mesh contradict (track_mesh.h)
//   4. focused matching, local refinement, local extrapolation (propagate.h); sub-pixel by patches (plane_patch.h)
//   5. labels: the set of planes that each match lies on (plane_labels.h)
//
// One plane is sought for all members at once; with poses it has 3 degrees of freedom. What ours leaves out is the
// chaining of matches from cell to cell.
#pragma once

#include "author/match/match.h"

namespace ibr {

struct HomographicOptions {
  bool posed = false;  // the poses hold: to about a pixel …
  bool exact = false;  // … or exactly: matches stay on their epipolar lines
  std::uint64_t seed = 1;
};

/// The frame is member 0's camera; vertices and their planes are given, `refined` is set. Precondition: 2 to 4 views.
/// Pictures that share no texture give a match without vertices that is good nowhere.
DenseMatch matchByHomographies(std::span<const MatchView> views, const HomographicOptions& options = {});

}  // namespace ibr
