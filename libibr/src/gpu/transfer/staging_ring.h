// SPDX-License-Identifier: Apache-2.0
// Host memory for uploads that travel in the caller's command buffers, taken in turn and given back frame by frame.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <deque>
#include <span>

#include "gpu/transfer/buffer.h"
#include "ibr/device.h"

namespace ibr {

/// Never waits: what frames still use is simply not there to be taken. The device must outlive it.
class StagingRing {
 public:
  StagingRing() = default;
  StagingRing(const Device& device, VkDeviceSize bytes);

  VkBuffer buffer() const noexcept { return buffer_.get(); }

  /// What can be taken at once now.
  VkDeviceSize room() const noexcept;

  struct Piece {
    VkDeviceSize offset;
    std::span<std::byte> memory;  // mapped, coherent
  };
  /// 1 to room() bytes, aligned for copies of any format, for commands of this frame. Frames come in order.
  Piece take(VkDeviceSize bytes, std::uint64_t frame);

  /// Frames up to this one have finished: what they took is free again.
  void release(std::uint64_t completedFrame);

 private:
  struct Taken {
    VkDeviceSize begin, end;
    std::uint64_t frame;
  };
  Buffer buffer_;
  VkDeviceSize head_ = 0;    // where the next piece begins, unless the end is too near
  std::deque<Taken> taken_;  // oldest first, each behind the last but where they begin anew
};

}  // namespace ibr
