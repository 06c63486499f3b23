// SPDX-License-Identifier: Apache-2.0
// Named stretches of commands: a label for debuggers and captures (VK_EXT_debug_utils, where enabled) and the device's
// time for them.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gpu/device/handle.h"
#include "ibr/device.h"

namespace ibr {

struct ScopeTime {
  std::string name;
  int depth = 0;  // 0: not inside another
  double milliseconds = 0;
};

/// Times of the scopes of one command buffer. A frame in flight needs one of its own. Names must be string literals or
/// live until read().
class ScopeTimer {
 public:
  /// Room for maxScopes a frame; further ones are labelled but not timed. 0: labels only.
  ScopeTimer(const Device& device, std::uint32_t maxScopes);

  /// Records the reset of all queries. First of all, outside a render pass.
  void reset(VkCommandBuffer commands) noexcept;
  void begin(VkCommandBuffer commands, const char* name) noexcept;
  void end(VkCommandBuffer commands) noexcept;  // of the scope begun last

  /// In the order of their beginnings, after the device has finished the commands; a scope lasts from the end of all
  /// work before it to the end of all work in it. What has not finished is left out; all is, where the queue has no
  /// timestamps.
  std::vector<ScopeTime> read() const;

 private:
  struct Scope {
    const char* name;
    int depth;
  };

  const Device* device_;
  PFN_vkCmdBeginDebugUtilsLabelEXT beginLabel_;
  PFN_vkCmdEndDebugUtilsLabelEXT endLabel_;
  double millisecondsPerTick_;
  std::uint64_t tickMask_ = 0;
  QueryPoolHandle queries_;  // begin and end of scope i at 2i and 2i + 1
  std::uint32_t maxScopes_ = 0;
  std::vector<Scope> scopes_;        // room for maxScopes_ is reserved: what records does not allocate
  std::vector<std::uint32_t> open_;  // indices into scopes_, outermost first
  std::uint32_t untimed_ = 0;        // open scopes without a time
};

/// Begins a scope and ends it with the block. Without a timer it does nothing.
class GpuScope {
 public:
  GpuScope(VkCommandBuffer commands, ScopeTimer* timer, const char* name) noexcept
      : commands_(commands), timer_(timer) {
    if (timer_) timer_->begin(commands_, name);
  }
  GpuScope(const GpuScope&) = delete;
  GpuScope& operator=(const GpuScope&) = delete;
  ~GpuScope() {
    if (timer_) timer_->end(commands_);
  }

 private:
  VkCommandBuffer commands_;
  ScopeTimer* timer_;
};

}  // namespace ibr
