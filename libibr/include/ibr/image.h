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
  int width = 0;          // px
  int height = 0;         // px
  int channels = 0;       // values per pixel
  std::vector<T> values;  // height × width × channels

  Image() = default;  // empty: 0 × 0 px
  /// Makes an image of w × h px with c channels, all values `fill`.
  Image(int w, int h, int c, T fill = T{})
      : width(w), height(h), channels(c), values(std::size_t(w) * std::size_t(h) * std::size_t(c), fill) {}

  bool empty() const { return values.empty(); }  // true if there are no values
  /// Returns the channels of a pixel: column x from the left, row y from the top. Precondition: inside the image.
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
using ImageF = Image<float>;         // channels and units: see the function that returns it

}  // namespace ibr
