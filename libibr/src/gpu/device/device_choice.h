// SPDX-License-Identifier: Apache-2.0
// What libibr needs of a physical device, what each lacks, and which one is taken.
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

/// In the loader's order, by which users number them.
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);

/// `lacking` covers Device::requirements() and the further extensions.
DeviceDescription describe(VkPhysicalDevice device, std::span<const std::string> extensions = {});

/// Adds those of requirements().optionalFeatures that the device has and DeviceOptions::disabledFeatures does not name.
void addOptionalFeatures(VkPhysicalDevice device, DeviceFeatures& features, const std::string& disabled = {});

/// Takes away those that are named.
void removeFeatures(DeviceFeatures& features, const std::string& disabled = {});

/// What requirements() names and the queue family does not offer.
std::vector<std::string> lackingOfQueueFamily(VkPhysicalDevice device, std::uint32_t family);

/// The first that serves, if any.
std::optional<std::uint32_t> queueFamily(VkPhysicalDevice device);

/// The index of the device that `option` wishes (index or part of the name), else IBR_DEVICE, else by type: discrete
/// GPU, integrated, virtual, CPU. Throws Error{unsupported} that names all devices and why each was rejected.
std::size_t choose(std::span<const DeviceDescription> devices, const std::string& option);

}  // namespace ibr
