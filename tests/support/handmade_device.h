// SPDX-License-Identifier: Apache-2.0
// Instance and device as an engine creates them from Device::requirements(), with validation.
#pragma once

#include <vulkan/vulkan_core.h>

#include <optional>

#include "base/vulkan/validation.h"
#include "ibr/device.h"

namespace ibr::test {

class HandmadeDevice {
 public:
  /// Uses the physical device of testDevice(). `apiVersion` 0: the required version.
  explicit HandmadeDevice(std::uint32_t apiVersion = 0);
  HandmadeDevice(const HandmadeDevice&) = delete;
  HandmadeDevice& operator=(const HandmadeDevice&) = delete;
  ~HandmadeDevice();

  DeviceHandles handles() const;

 private:
  Messages messages_;
  VkInstance instance_ = VK_NULL_HANDLE;
  std::optional<Messenger> messenger_;
  VkPhysicalDevice physicalDevice_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queueFamily_ = 0;
};

}  // namespace ibr::test
