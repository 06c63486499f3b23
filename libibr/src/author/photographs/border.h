// SPDX-License-Identifier: Apache-2.0
// Removes triangles in the black border of undistorted photographs that keep all photographed pixels (Border::keep).
#pragma once

#include <limits>
#include <span>

#include "author/photographs/photographs.h"
#include "ibr/scene.h"

namespace ibr {

/// Remainder of tier 0, by areas in the first member.
struct BorderCut {
  double left = 1;                                        // remaining share; 1 without a border
  double ecc = std::numeric_limits<double>::quiet_NaN();  // mean of MorphMesh::ecc over the remainder; NaN if nothing
};

/// Removes triangles that reach into a member's border; vertices stay. Tier 0 stays before tier 1.
BorderCut dropBorder(MorphMesh& mesh, std::span<const Photograph* const> members);

}  // namespace ibr
