// SPDX-License-Identifier: Apache-2.0
// Command buffers of the frames that are in flight. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "gpu/draw/scope.h"
#include "gpu/transfer/frame_slot.h"
#include "ibr/device.h"

namespace ibr::app {

class FrameRing {
 public:
  static constexpr std::uint32_t kSlots = 2;

  /// The device has a queueMutex.
  explicit FrameRing(const Device& device);
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;
  ~FrameRing();  // waits for all of them

  struct Frame {
    VkCommandBuffer commands;         // begun
    std::uint32_t slot;               // 0 to kSlots − 1: what was used with it before is free again
    std::uint64_t number, completed;  // from 1; `completed` and all before it are done
    ScopeTimer* timer;                // reset
  };
  /// Waits until the frame that had this slot is done.
  Frame begin();
  /// Throws Error (deviceLost, outOfMemory).
  void submit(const Frame& frame);
  /// Until all that was submitted is done.
  void wait() const;

  /// Milliseconds that the device took for the frame that had the slot of `begin`'s last frame before it; 0: unknown.
  double deviceMs() const noexcept { return deviceMs_; }

 private:
  struct Slot : FrameSlot {
    std::unique_ptr<ScopeTimer> timer;
  };
  const Device& device_;
  std::array<Slot, kSlots> slots_;
  std::uint64_t frames_ = 0;
  double deviceMs_ = 0;
};

}  // namespace ibr::app
