// SPDX-License-Identifier: Apache-2.0
// Texel format of a photograph for stars: a word of three signed bytes (level − 128, red lowest). A border of one texel
// repeats the photograph's border, so that reads need no bounds check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/image.h"

namespace ibr {

inline constexpr std::size_t kTexelOverrun = 8;  // words that a vector read may pass the last row's end

struct Texels {
  int stride = 0;                    // words from row to row: width + 2
  std::vector<std::uint32_t> words;  // (width + 2) × (height + 2), and the overrun
  /// Texel (x, y) of the photograph, −1 <= x <= width, −1 <= y <= height.
  const std::uint32_t* at(int x, int y) const { return words.data() + std::ptrdiff_t(y + 1) * stride + (x + 1); }
};

/// Converts an RGB photograph.
Texels texelsOf(const Image8& picture);

}  // namespace ibr
