// SPDX-License-Identifier: Apache-2.0
// Completes the depth of a photograph where matching found none (tier 2; ARCHITECTURE §5, "Tiers").
//
//   Known pixels keep their inverse depth ρ. Elsewhere ρ is a membrane: harmonic between the known pixels, with
//   conductances that fall where the photograph's colours change (Levin, Lischinski & Weiss 2004 do so for colours). A
//   plane is linear in ρ, so that the ground goes on as a plane, and a hole leans neither to its near nor to its far
//   rim. A region without depth stays between the smallest and the largest ρ on its rim: nothing is extrapolated.
#pragma once

#include "ibr/image.h"

namespace ibr {

inline constexpr float kUnknownDepth = -1.0f;

/// `inverseDepth`: ρ, one channel, 1 / world unit, >= 0 or kUnknownDepth; `colours`: RGB, the same size. Returns ρ = 0
/// (infinity) everywhere where no pixel is known.
ImageF completeDepth(const ImageF& inverseDepth, const Image8& colours);

}  // namespace ibr
