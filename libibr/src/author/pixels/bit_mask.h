// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace ibr {

/// A mask with one bit per pixel.
class BitMask {
 public:
  BitMask() = default;
  BitMask(int width, int height) : width_(width), height_(height), bits_(std::size_t(width) * std::size_t(height)) {}

  bool empty() const { return bits_.empty(); }
  int width() const { return width_; }
  int height() const { return height_; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  bool at(int x, int y) const { return bits_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }
  void set(int x, int y, bool value) { bits_[std::size_t(y) * std::size_t(width_) + std::size_t(x)] = value; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<bool> bits_;
};

}  // namespace ibr
