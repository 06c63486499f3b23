// SPDX-License-Identifier: Apache-2.0
// Which pixels of a photograph show the sky: infinity explains them hardly worse than any depth does, and they hang
// together with the picture's upper border, or infinity is as good as any depth in half of them. Where nothing matches
// at any depth, as in a clear sky, infinity may be worse by more; walls without texture are not reached, since their
// outlines match at their depth.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// 255 where sky is, else 0; one channel. `infinityExcess`: SemiGlobalMatch::firstExcess of a sweep that begins at
/// infinity; `cost`: of the matched depth, 127 where nothing correlates. Both of one size.
Image8 skyOf(const ImageF& infinityExcess, const Image8& cost);

}  // namespace ibr
