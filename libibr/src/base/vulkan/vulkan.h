// SPDX-License-Identifier: Apache-2.0
// Turns results of Vulkan calls into exceptions, and queries the loader.
#pragma once

#include <vulkan/vulkan_core.h>

#include <string_view>

#include "ibr/device.h"

namespace ibr {

/// The enumerator, such as "VK_ERROR_DEVICE_LOST"; "unknown VkResult" for those of extensions that libibr does not use.
const char* resultName(VkResult result) noexcept;

/// Throws Error (outOfMemory, deviceLost, unsupported, else vulkan) with call and result unless VK_SUCCESS.
void vk(VkResult result, const char* call);

/// As above, for calls that can report a lost device, which is then marked lost (Device::isLost).
void vk(const Device& device, VkResult result, const char* call);

/// Throws Error{deviceLost} with the call if the device is lost; used before the call is made.
void checkAlive(const Device& device, const char* call);

/// True if the loader or a driver has the instance extension; with `layer`, if that layer has it. Throws as vk().
bool hasInstanceExtension(std::string_view name, const char* layer = nullptr);

}  // namespace ibr
