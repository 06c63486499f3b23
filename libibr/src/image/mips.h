// SPDX-License-Identifier: Apache-2.0
// Mip chains of photographs.
#pragma once

#include <vector>

#include "ibr/image.h"

namespace ibr {

/// RGBA8 levels from the image itself (alpha 255 for RGB) down to 1×1, each max(1, ⌊side / 2⌋) of the previous. Each
/// level is the exact box filter of the previous one in linear light, also for odd sizes. Deterministic. Throws
/// Error{invalidInput} unless the image has 3 or 4 channels and at least one pixel.
std::vector<Image8> buildMips(const Image8& rgbOrRgba);

}  // namespace ibr
