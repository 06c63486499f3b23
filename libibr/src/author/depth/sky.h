// SPDX-License-Identifier: Apache-2.0
// Finds the sky. A sky pixel's best cost is hardly lower than its cost at infinity. A sky region touches the image's
// upper border, or infinity is the best depth in half of it. Where no depth matches, as in a clear sky, infinity may be
// worse by more. Walls without texture are excluded, since their outlines match at their own depth.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// Returns 255 for sky, else 0; one channel. `infinityExcess`: SemiGlobalMatch::firstExcess of a sweep from infinity.
/// `cost`: of the matched depth, 127 where nothing correlates. Both have the same size.
Image8 skyOf(const ImageF& infinityExcess, const Image8& cost);

}  // namespace ibr
