// SPDX-License-Identifier: Apache-2.0
// What every picture metric asks of its pictures.
#pragma once

#include "base/check.h"
#include "ibr/image.h"

namespace ibr {

/// Throws Error{invalidInput} unless both are of one size and have colours, and the mask, if any, is of that size and
/// has one channel.
inline void checkComparable(const Image8& a, const Image8& b, const Image8* mask) {
  check(a.width == b.width && a.height == b.height, ErrorCode::invalidInput,
        "pictures of {}x{} and {}x{} differ in size", a.width, a.height, b.width, b.height);
  check(a.channels >= 3 && b.channels >= 3, ErrorCode::invalidInput, "pictures of {} and {} channels have no colour",
        a.channels, b.channels);
  if (mask)
    check(mask->width == a.width && mask->height == a.height && mask->channels == 1, ErrorCode::invalidInput,
          "mask of {}x{} with {} channels for pictures of {}x{}", mask->width, mask->height, mask->channels, a.width,
          a.height);
}

}  // namespace ibr
