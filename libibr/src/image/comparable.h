// SPDX-License-Identifier: Apache-2.0
// Preconditions that all image metrics share.
#pragma once

#include "base/check.h"
#include "ibr/image.h"

namespace ibr {

/// Throws Error{invalidInput} unless both images have the same size and at least 3 channels, and the mask, if any, has
/// the same size and one channel.
inline void checkComparable(const Image8& a, const Image8& b, const Image8* mask) {
  check(a.width == b.width && a.height == b.height, ErrorCode::invalidInput, "images of {}x{} and {}x{} differ in size",
        a.width, a.height, b.width, b.height);
  check(a.channels >= 3 && b.channels >= 3, ErrorCode::invalidInput,
        "images of {} and {} channels: at least 3 are needed", a.channels, b.channels);
  if (mask)
    check(mask->width == a.width && mask->height == a.height && mask->channels == 1, ErrorCode::invalidInput,
          "mask of {}x{} with {} channels does not have the size {}x{} and 1 channel", mask->width, mask->height,
          mask->channels, a.width, a.height);
}

}  // namespace ibr
