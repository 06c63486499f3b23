// SPDX-License-Identifier: Apache-2.0
// A scope of a ScopeTimer, bound to a C++ block.
#pragma once

#include "ibr/scope_timer.h"

namespace ibr {

/// Has no effect without a timer.
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
