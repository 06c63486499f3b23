// SPDX-License-Identifier: Apache-2.0
// A Vulkan instance of our own, and the way of the validation layer's messages.
#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "ibr/log.h"

namespace ibr {

/// Where messages go. Layers may send from any thread.
class Messages {
 public:
  explicit Messages(LogCallback log);
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  void send(LogLevel level, std::string_view text);
  void sendValidation(LogLevel level, std::string_view text);  // counts as well
  std::uint64_t validationMessages() const noexcept { return validationMessages_; }

 private:
  std::mutex mutex_;
  LogCallback log_;
  std::atomic<std::uint64_t> validationMessages_{0};
};

class Instance {
 public:
  /// Null, as for a borrowed device.
  Instance() = default;
  /// Debug utils are enabled where there are such. With validation: VK_LAYER_KHRONOS_validation with synchronisation
  /// validation, errors and warnings to `messages`, which must outlive the instance. Throws Error{unsupported} that
  /// names what is missing: a driver, the layer, an extension.
  Instance(std::span<const std::string> extensions, bool validation, Messages& messages);
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance();

  VkInstance get() const noexcept { return instance_; }

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace ibr
