// SPDX-License-Identifier: Apache-2.0
// Pool of host memory for uploads in the caller's command buffers. Pieces may be written by other threads.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/vulkan/buffer.h"
#include "ibr/device.h"

namespace ibr {

/// Never waits: memory that is in use is not available. Only the constructor allocates memory. The device must outlive
/// the pool. One thread at a time calls the member functions; the memory of a piece belongs to whoever took the piece.
class StagingPool {
 public:
  StagingPool() = default;
  /// `maxPieces`: that are in use at a time.
  StagingPool(const Device& device, VkDeviceSize bytes, std::size_t maxPieces);

  VkBuffer buffer() const noexcept { return buffer_.get(); }
  VkDeviceSize size() const noexcept { return buffer_.size(); }

  struct Piece {
    VkDeviceSize offset = 0;
    std::span<std::byte> memory = {};  // mapped, coherent
  };
  /// Takes at least 1 byte, aligned for copies of any format. Returns nullopt where no free range is large enough, or
  /// maxPieces are in use.
  std::optional<Piece> take(VkDeviceSize bytes);

  /// Frees a piece that no commands read.
  void release(const Piece& piece);
  /// Frees a piece as soon as release() is called with `frame` or a later one, whose commands read the piece.
  void releaseAfter(const Piece& piece, std::uint64_t frame);
  /// Frees pieces of all frames up to completedFrame, which the device has finished.
  void release(std::uint64_t completedFrame);

 private:
  static constexpr std::uint64_t kTaken = ~std::uint64_t(0);

  struct Range {
    VkDeviceSize begin, end;
    std::uint64_t frame;  // the last one that reads the range; kTaken: not released yet
  };
  std::vector<Range>::iterator find(const Piece& piece);

  Buffer buffer_;
  std::vector<Range> used_;  // ascending
};

}  // namespace ibr
