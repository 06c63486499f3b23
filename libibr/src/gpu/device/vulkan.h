// SPDX-License-Identifier: Apache-2.0
// Results of Vulkan calls as exceptions, and what the loader has.
#pragma once

#include <vulkan/vulkan_core.h>

#include <string_view>

#include "ibr/device.h"

namespace ibr {

/// The enumerator, such as "VK_ERROR_DEVICE_LOST"; "an unknown VkResult" for those of extensions that we do not use.
const char* resultName(VkResult result) noexcept;

/// Throws Error (outOfMemory, deviceLost, unsupported, else vulkan) that names call and result unless it is VK_SUCCESS.
void vk(VkResult result, const char* call);

/// The same, of a call that a device may be lost in: then it is from now on (Device::isLost).
void vk(const Device& device, VkResult result, const char* call);

/// Throws Error{deviceLost} that names the call, before it is made of a device that is lost.
void checkAlive(const Device& device, const char* call);

/// Whether the loader and the drivers have an instance extension, or with `layer` that layer. Throws as vk().
bool hasInstanceExtension(std::string_view name, const char* layer = nullptr);

}  // namespace ibr
