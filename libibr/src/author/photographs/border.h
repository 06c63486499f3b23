// SPDX-License-Identifier: Apache-2.0
// The black border of undistorted photographs that keep all that was photographed (Border::keep): no mesh shows it.
#pragma once

#include <limits>
#include <span>

#include "author/photographs/photographs.h"
#include "ibr/scene.h"

namespace ibr {

/// What is left of tier 0, by areas in the first member.
struct BorderCut {
  double left = 1;                                        // share of it; 1 where there is no border
  double ecc = std::numeric_limits<double>::quiet_NaN();  // mean of MorphMesh::ecc over it; NaN where nothing is left
};

/// Leaves out triangles that reach into the border of a member; vertices stay. A mesh's tier 0 stays before tier 1.
BorderCut dropBorder(MorphMesh& mesh, std::span<const Photograph* const> members);

}  // namespace ibr
