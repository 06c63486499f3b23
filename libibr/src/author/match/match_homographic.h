// SPDX-License-Identifier: Apache-2.0
// Match of 2 to 4 photographs by homographic decomposition, [T]'s reference 25 (Seibt, von Rymon Lipinski & Latoschik,
// Dense Feature Matching Based on Homographic Decomposition, IEEE Access 2022), as far as published.
//
//   1. features everywhere (features.h)
//   2. match, find the largest plane, seal its matches, repeat (homographies.h); without poses match the rest again
//   3. drop matches that their neighbours on the Delaunay mesh contradict (track_mesh.h)
//   4. focused matching, local refinement, local extrapolation (propagate.h); sub-pixel by patches (plane_patch.h)
//   5. labels: the set of planes that each match lies on (plane_labels.h)
//
// Planes are searched for all members together; with poses a plane has 3 degrees of freedom. The paper's chaining of
// matches from cell to cell is not implemented.
#pragma once

#include "author/match/match.h"

namespace ibr {

struct HomographicOptions {
  bool posed = false;  // poses are accurate to about a pixel …
  bool exact = false;  // … or exact: matches stay on their epipolar lines
  std::uint64_t seed = 1;
};

/// The frame is member 0's camera; vertices and their planes are given, `refined` is set. Precondition: 2 to 4 views.
/// Images that share no texture give a match without vertices that is good nowhere.
DenseMatch matchByHomographies(std::span<const MatchView> views, const HomographicOptions& options = {});

}  // namespace ibr
