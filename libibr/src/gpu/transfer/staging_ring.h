// SPDX-License-Identifier: Apache-2.0
// Ring of host memory for uploads in the caller's command buffers; space is freed frame by frame.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <deque>
#include <span>

#include "base/vulkan/buffer.h"
#include "ibr/device.h"

namespace ibr {

/// Never waits: space that frames still use is not available. The device must outlive the ring.
class StagingRing {
 public:
  StagingRing() = default;
  StagingRing(const Device& device, VkDeviceSize bytes);

  VkBuffer buffer() const noexcept { return buffer_.get(); }

  /// Number of bytes that one allocate() can return at present.
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
  struct Allocation {
    VkDeviceSize begin, end;
    std::uint64_t frame;
  };
  Buffer buffer_;
  VkDeviceSize head_ = 0;               // begin of the next piece, unless the end is too near
  std::deque<Allocation> allocations_;  // oldest first; contiguous but for the wrap-around
};

}  // namespace ibr
