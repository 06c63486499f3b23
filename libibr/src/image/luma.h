// SPDX-License-Identifier: Apache-2.0
// Images in one channel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Rec. 601 luma of display-encoded 8-bit levels.
inline double luma(std::span<const std::uint8_t> pixel) {
  return 0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2];
}

struct Luma {
  int width = 0, height = 0;
  std::vector<double> values;  // 8-bit levels, row by row
  double at(int x, int y) const { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

inline Luma lumaOf(const Image8& picture) {
  Luma result{picture.width, picture.height, {}};
  result.values.reserve(std::size_t(picture.width) * std::size_t(picture.height));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) result.values.push_back(luma(picture.pixel(x, y)));
  return result;
}

}  // namespace ibr
