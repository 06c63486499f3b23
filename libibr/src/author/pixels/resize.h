// SPDX-License-Identifier: Apache-2.0
// Pictures made smaller or grey.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// RGB, averaged over areas.
Image8 shrunk(const Image8& picture, int width, int height);

/// Luma of RGB, one channel.
Image8 greyOf(const Image8& picture);

}  // namespace ibr
