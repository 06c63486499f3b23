// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/debug.h"

#include <string>

#include "base/vulkan/functions.h"

namespace ibr {

void nameObject(const Device& device, VkObjectType type, std::uint64_t handle, std::string_view name) {
  // Null if the extension is not enabled, also in an instance that the caller made.
  const auto setName = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
      vkGetInstanceProcAddr(device.instance(), "vkSetDebugUtilsObjectNameEXT"));
  if (!setName) return;
  const std::string text(name);
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .objectType = type,
                                           .objectHandle = handle,
                                           .pObjectName = text.c_str()};
  setName(device.handle(), &info);  // names are for debugging only, so a failure is ignored
}

}  // namespace ibr
