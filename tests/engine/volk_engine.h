// SPDX-License-Identifier: Apache-2.0
// Instance, device and queue of an engine that uses volk, with validation.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "ibr/device.h"

namespace ibr::test {

class VolkEngine {
 public:
  /// Uses the physical device of this name. Throws std::runtime_error.
  explicit VolkEngine(const std::string& physicalDevice);
  VolkEngine(const VolkEngine&) = delete;
  VolkEngine& operator=(const VolkEngine&) = delete;
  ~VolkEngine();

  VkInstance instance() const { return instance_; }
  DeviceHandles handles() const;
  std::uint64_t validationMessages() const { return messages_; }

 private:
  void makeInstance();
  void makeDevice(const std::string& name);

  std::atomic<std::uint64_t> messages_ = 0;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queueFamily_ = 0;
};

}  // namespace ibr::test
