// SPDX-License-Identifier: Apache-2.0
// Images defined by a formula. Other programs can generate the same images, so tests can use those programs' results.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// Values are (x · alongX + y · alongY + channel · apart) mod 256.
inline Image8 ramp(int width, int height, int alongX, int alongY, int apart) {
  Image8 image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[std::size_t(c)] = std::uint8_t((x * alongX + y * alongY + c * apart) & 255);
  return image;
}

/// Squares of `side` pixels, each with its own level in each channel.
inline Image8 blocks(int width, int height, int side, std::uint64_t seed) {
  Image8 image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        const std::uint64_t key =
            std::uint64_t(x / side) * 7919 + std::uint64_t(y / side) * 104729 + std::uint64_t(c) * 1299709 + seed;
        image.pixel(x, y)[std::size_t(c)] = std::uint8_t((((key * 1103515245 + 12345) & 0x7fffffff) >> 16) & 255);
      }
  return image;
}

/// Moves each row down by one pixel; the last row becomes the first.
inline Image8 rolled(const Image8& image) {
  Image8 result = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        result.pixel((x + 1) % image.width, y)[std::size_t(c)] = image.pixel(x, y)[std::size_t(c)];
  return result;
}

}  // namespace ibr
