// SPDX-License-Identifier: Apache-2.0
// Ring of host memory for uploads in the caller's command buffers; space is freed frame by frame.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/vulkan/buffer.h"
#include "ibr/device.h"

namespace ibr {

/// Never waits: space that frames still use is not available. Only the constructor allocates memory. The device must
/// outlive the ring.
class StagingRing {
 public:
  StagingRing() = default;
  StagingRing(const Device& device, VkDeviceSize bytes);

  VkBuffer buffer() const noexcept { return buffer_.get(); }

  /// Number of bytes that one allocate() can return at present; 0 where more than kMaxRanges ranges are in use.
  VkDeviceSize freeBytes() const noexcept;

  struct Piece {
    VkDeviceSize offset;
    std::span<std::byte> memory;  // mapped, coherent
  };
  /// Takes 1 to freeBytes() bytes, aligned for copies of any format, for commands of `frame`. Frame numbers ascend.
  Piece allocate(VkDeviceSize bytes, std::uint64_t frame);

  /// Frees the pieces of all frames up to completedFrame, which the device has finished.
  void release(std::uint64_t completedFrame);

 private:
  struct Range {  // consecutive pieces of one frame
    VkDeviceSize begin, end;
    std::uint64_t frame;
  };
  static constexpr std::size_t kMaxRanges = 64;  // a frame has at most two; frames in flight are far fewer

  Range& range(std::size_t index) noexcept { return ranges_[(first_ + index) % kMaxRanges]; }
  const Range& range(std::size_t index) const noexcept { return ranges_[(first_ + index) % kMaxRanges]; }

  Buffer buffer_;
  VkDeviceSize head_ = 0;                   // begin of the next piece, unless the end is too near
  std::array<Range, kMaxRanges> ranges_{};  // in use: count_ from first_ on, oldest first; contiguous but for the
  std::size_t first_ = 0, count_ = 0;       // wrap-around
};

}  // namespace ibr
