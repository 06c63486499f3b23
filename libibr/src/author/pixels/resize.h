// SPDX-License-Identifier: Apache-2.0
// Scales images down, or converts them to grey.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// Scales RGB down by area averaging.
Image8 shrunk(const Image8& picture, int width, int height);

/// Luma of RGB, one channel.
Image8 greyOf(const Image8& picture);

}  // namespace ibr
