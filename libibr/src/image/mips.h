// SPDX-License-Identifier: Apache-2.0
// Mip chains of photographs.
#pragma once

#include <vector>

#include "ibr/image.h"

namespace ibr {

/// RGBA8 levels from the picture itself (alpha 255 where it had none) down to 1×1, each max(1, ⌊side / 2⌋) of the last.
/// Each level is the exact box filter of the last, also for odd sizes, averaged in linear light. Deterministic.
/// Throws Error{invalidInput} unless the picture has 3 or 4 channels and at least one pixel.
std::vector<Image8> buildMips(const Image8& rgbOrRgba);

}  // namespace ibr
