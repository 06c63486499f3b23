// SPDX-License-Identifier: Apache-2.0
// Command buffers of the frames in flight. Threading: one thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "base/vulkan/frame_slot.h"
#include "ibr/device.h"
#include "ibr/scope_timer.h"

namespace ibr::app {

class FrameRing {
 public:
  static constexpr std::uint32_t kSlots = 2;

  explicit FrameRing(const Device& device);
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;
  ~FrameRing();  // waits for all frames

  struct Frame {
    VkCommandBuffer commands;         // recording has begun
    std::uint32_t slot;               // 0 to kSlots − 1; the slot's previous frame has finished
    std::uint64_t number, completed;  // from 1; the device has finished `completed` and all frames before it
    ScopeTimer* timer;                // already reset
  };
  /// Waits until the slot's previous frame has finished.
  Frame begin();
  /// Throws Error (deviceLost, outOfMemory).
  void submit(const Frame& frame);
  /// Waits until the device has finished all submitted frames.
  void wait() const;

  /// Device time, ms, of the frame that used the slot before the last frame of `begin`; 0: unknown.
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
