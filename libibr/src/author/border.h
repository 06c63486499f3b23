// SPDX-License-Identifier: Apache-2.0
// The black border of undistorted photographs that keep all that was photographed (Border::keep): no mesh shows it.
#pragma once

#include <span>

#include "author/photographs.h"
#include "ibr/scene.h"

namespace ibr {

/// Leaves out triangles that reach into the border of a member; vertices stay. A mesh's tier 0 stays before tier 1.
/// Returns the share of the area of tier 0, in the first member, that is left: 1 where there is no border.
double dropBorder(MorphMesh& mesh, std::span<const Photograph* const> members);

}  // namespace ibr
