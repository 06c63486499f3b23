// SPDX-License-Identifier: Apache-2.0
// Names and labels for debuggers and validation messages (VK_EXT_debug_utils). No effect without the extension.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string_view>

#include "ibr/device.h"

namespace ibr {

void nameObject(const Device& device, VkObjectType type, std::uint64_t handle, std::string_view name);

/// Overload for a handle of any type.
template <class T>
void nameObject(const Device& device, VkObjectType type, T* handle, std::string_view name) {
  nameObject(device, type, reinterpret_cast<std::uint64_t>(handle), name);
}

}  // namespace ibr
