// SPDX-License-Identifier: Apache-2.0
// Lists physical devices with the requirements that each one lacks, and chooses one.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ibr/device.h"

namespace ibr {

/// Devices in the loader's order, which is their numbering for users.
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);

/// `missing` covers Device::requirements() and the further extensions.
DeviceDescription describe(VkPhysicalDevice device, std::span<const std::string> extensions = {});

/// Adds the device's features of requirements().optionalFeatures that DeviceOptions::disabledFeatures does not name.
void addOptionalFeatures(VkPhysicalDevice device, DeviceFeatures& features, const std::string& disabled = {});

/// Removes the features that `disabled` names.
void removeFeatures(DeviceFeatures& features, const std::string& disabled = {});

/// Requirements of requirements() that the queue family does not meet.
std::vector<std::string> missingQueueCapabilities(VkPhysicalDevice device, std::uint32_t family);

/// Index of the first queue family that meets the requirements, if any.
std::optional<std::uint32_t> queueFamily(VkPhysicalDevice device);

/// Index of the device that `option` names (index or part of the name), else IBR_DEVICE, else the best type: discrete,
/// integrated, virtual GPU, CPU. Throws Error{unsupported} with all devices and the reason why each was rejected.
std::size_t choose(std::span<const DeviceDescription> devices, const std::string& option);

}  // namespace ibr
