// SPDX-License-Identifier: Apache-2.0
// Depth for every pixel of a photograph, from what matching found in parts of it (tier 2; ARCHITECTURE §5, "Tiers").
//
//   known pixels keep their value; elsewhere φ(w) = 1 / (w + w₀)², w the inverse depth, is harmonic between them, with
//   conductances that fall where the photograph's colours change (Levin, Lischinski & Weiss 2004 for colours, by
//   depths): a mean in φ leans to the far side, so that what stands before something does not grow into its holes.
//   A region without depth stays between the nearest and the farthest value on its rim: nothing is extrapolated.
#pragma once

#include "ibr/image.h"

namespace ibr {

inline constexpr float kUnknownDepth = -1.0f;

/// `inverseDepth`: one channel, >= 0 or kUnknownDepth; `colours`: RGB, the same size. Where nothing at all is known
/// everything is at infinity.
ImageF completeDepth(const ImageF& inverseDepth, const Image8& colours);

}  // namespace ibr
