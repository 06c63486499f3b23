// SPDX-License-Identifier: Apache-2.0
// A photograph as stars read it: a texel is a word of three signed bytes (a level less 128, red lowest), with a border
// of one texel that repeats the picture's, so that no read needs a bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/image.h"

namespace ibr {

inline constexpr std::size_t kTexelOverrun = 8;  // words that a vector's read may go beyond the last row

struct Texels {
  int stride = 0;                    // words from row to row: width + 2
  std::vector<std::uint32_t> words;  // (width + 2) × (height + 2), and the overrun
  /// Texel (x, y) of the picture, −1 <= x <= width, −1 <= y <= height.
  const std::uint32_t* at(int x, int y) const { return words.data() + std::ptrdiff_t(y + 1) * stride + (x + 1); }
};

/// `picture` is RGB.
Texels texelsOf(const Image8& picture);

}  // namespace ibr
