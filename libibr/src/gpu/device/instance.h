// SPDX-License-Identifier: Apache-2.0
// A Vulkan instance that libibr owns.
#pragma once

#include <vulkan/vulkan_core.h>

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/vulkan/validation.h"

namespace ibr {

class Instance {
 public:
  /// Null, for a borrowed device.
  Instance() = default;
  /// Enables debug utils if available. With validation (base/vulkan/validation.h), errors and warnings go to
  /// `messages`, which must outlive the instance. Throws Error{unsupported} with the missing part: a driver, the layer,
  /// an extension.
  Instance(std::span<const std::string> extensions, bool validation, Messages& messages);

  VkInstance get() const noexcept { return instance_.get(); }

 private:
  struct Destroy {
    PFN_vkDestroyInstance call;  // null if the caller's vkGetInstanceProcAddr lacks the function
    void operator()(VkInstance instance) const noexcept {
      if (call) call(instance, nullptr);
    }
  };
  std::unique_ptr<VkInstance_T, Destroy> instance_;
  std::optional<Messenger> messenger_;
};

}  // namespace ibr
