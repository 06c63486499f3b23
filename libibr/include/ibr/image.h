// SPDX-License-Identifier: Apache-2.0
// An image in memory.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ibr {

/// height × width × channels values, rows from the top, interleaved, no padding.
template <class T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<T> values;

  Image() = default;
  Image(int w, int h, int c, T fill = T{})
      : width(w), height(h), channels(c), values(std::size_t(w) * std::size_t(h) * std::size_t(c), fill) {}

  bool empty() const { return values.empty(); }
  std::span<T> pixel(int x, int y) { return {&values[index(x, y)], std::size_t(channels)}; }
  std::span<const T> pixel(int x, int y) const { return {&values[index(x, y)], std::size_t(channels)}; }
  bool operator==(const Image&) const = default;

 private:
  std::size_t index(int x, int y) const {
    assert(x >= 0 && x < width && y >= 0 && y < height);
    return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels);
  }
};

using Image8 = Image<std::uint8_t>;  // display-encoded (sRGB); channels: 1 grey, 3 RGB, 4 RGBA
using ImageF = Image<float>;

}  // namespace ibr
