// SPDX-License-Identifier: Apache-2.0
// Vulkan validation for libibr's own instance or for an instance that others make (an OpenXR runtime):
//
//   Messages messages(log);
//   const Validation validation(messages);       // into the create-info: kLayer, kExtensions, chain()
//   …                                            // the instance is made
//   const Messenger messenger(instance, messages);
//   DeviceHandles handles{…, .validationMessages = &messages.validationMessages()};
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "ibr/log.h"

namespace ibr {

/// Receives messages. Layers may send from any thread.
class Messages {
 public:
  explicit Messages(LogCallback log);
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  void send(LogLevel level, std::string_view text);
  void sendValidation(LogLevel level, std::string_view text);  // counted by validationMessages()
  const std::atomic<std::uint64_t>& validationMessages() const noexcept { return validationMessages_; }

 private:
  std::mutex mutex_;
  LogCallback log_;
  std::atomic<std::uint64_t> validationMessages_{0};
};

/// Parts of the create-info of an instance with core and synchronisation validation.
class Validation {
 public:
  static constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
  static constexpr std::array kExtensions{VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};

  /// Errors and warnings while the instance is made and destroyed go to `messages`, which must outlive the instance.
  /// Throws Error{unsupported} with the missing part: the layer, an extension.
  explicit Validation(Messages& messages);
  Validation(const Validation&) = delete;
  Validation& operator=(const Validation&) = delete;

  /// For VkInstanceCreateInfo::pNext; valid while *this lives.
  const void* chain() const noexcept { return &features_; }

 private:
  VkDebugUtilsMessengerCreateInfoEXT messenger_;
  VkValidationFeaturesEXT features_;
};

/// Sends an instance's errors and warnings to `messages` while it lives.
class Messenger {
 public:
  /// The instance has VK_EXT_debug_utils. Instance and messages outlive the object. Throws as vk().
  Messenger(VkInstance instance, Messages& messages);
  Messenger(const Messenger&) = delete;
  Messenger& operator=(const Messenger&) = delete;
  ~Messenger();

 private:
  VkInstance instance_;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace ibr
