// SPDX-License-Identifier: Apache-2.0
// GPU times of named scopes in a command buffer, and labels of the same names for debuggers (VK_EXT_debug_utils, where
// it is enabled).
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ibr/device.h"
#include "ibr/export.h"

namespace ibr {

/// GPU time of a scope.
struct ScopeTime {
  std::string name;         // as passed to ScopeTimer::begin()
  int depth = 0;            // number of scopes around it
  double milliseconds = 0;  // GPU time
};

/// Times the scopes of one command buffer. Each frame in flight needs its own timer. Names must be string literals or
/// live until read(). The device must outlive the timer. One thread at a time uses a timer.
class IBR_API ScopeTimer {
 public:
  /// Allocates room for maxScopes a frame. Further scopes are labelled but not timed; 0: labels only. Submits nothing.
  /// Throws Error.
  ScopeTimer(const Device& device, std::uint32_t maxScopes);
  ScopeTimer(ScopeTimer&&) noexcept;
  ScopeTimer& operator=(ScopeTimer&&) noexcept;
  ~ScopeTimer();  // frees device memory; does not wait

  /// Records the reset of all queries. Must be recorded before any scope, outside a render pass. Neither waits nor
  /// allocates.
  void reset(VkCommandBuffer commandBuffer) noexcept;
  /// Begins a scope inside the scopes that have not ended. Neither waits nor allocates.
  void begin(VkCommandBuffer commandBuffer, const char* name) noexcept;
  /// Ends the scope begun last. Neither waits nor allocates.
  void end(VkCommandBuffer commandBuffer) noexcept;

  /// Returns the times, in the order in which scopes began, once the device has finished the commands. Allocates host
  /// memory; does not wait. A scope lasts from
  /// the end of all work before it to the end of all work in it. Unfinished scopes are left out; all are, where the
  /// queue has no timestamps. Throws Error{deviceLost}.
  std::vector<ScopeTime> read() const;

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

/// Times a scope from its construction to its destruction. Has no effect without a timer.
class GpuScope {
 public:
  /// Begins the scope. `timer` may be null. The command buffer and the timer must outlive the scope.
  GpuScope(VkCommandBuffer commands, ScopeTimer* timer, const char* name) noexcept
      : commands_(commands), timer_(timer) {
    if (timer_) timer_->begin(commands_, name);
  }
  GpuScope(const GpuScope&) = delete;
  GpuScope& operator=(const GpuScope&) = delete;
  /// Ends the scope.
  ~GpuScope() {
    if (timer_) timer_->end(commands_);
  }

 private:
  VkCommandBuffer commands_;
  ScopeTimer* timer_;
};

}  // namespace ibr
