// SPDX-License-Identifier: Apache-2.0
// Completes the depth of a photograph where matching found none (tier 2).
//
// Known pixels keep their inverse depth ρ. Elsewhere ρ is a membrane: harmonic between the known pixels, with
// conductances that fall where the colours change (as Levin, Lischinski & Weiss 2004 do for colours). A plane is linear
// in ρ, so the ground continues as a plane, and a hole leans neither to its near nor to its far rim. A region without
// depth stays between the min and max ρ on its rim: nothing is extrapolated.
#pragma once

#include "ibr/image.h"

namespace ibr {

inline constexpr float kUnknownDepth = -1.0f;

/// `inverseDepth`: ρ, one channel, 1 / world unit, >= 0 or kUnknownDepth. `colours`: RGB, the same size. Returns ρ = 0
/// (infinity) everywhere if no pixel is known.
ImageF completeDepth(const ImageF& inverseDepth, const Image8& colours);

}  // namespace ibr
