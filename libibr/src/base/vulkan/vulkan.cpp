// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/vulkan.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/check.h"
#include "base/vulkan/functions.h"

namespace ibr {

const char* resultName(VkResult result) noexcept {
#define IBR_RESULT(name) \
  case name:             \
    return #name
  switch (result) {
    IBR_RESULT(VK_SUCCESS);
    IBR_RESULT(VK_NOT_READY);
    IBR_RESULT(VK_TIMEOUT);
    IBR_RESULT(VK_EVENT_SET);
    IBR_RESULT(VK_EVENT_RESET);
    IBR_RESULT(VK_INCOMPLETE);
    IBR_RESULT(VK_SUBOPTIMAL_KHR);
    IBR_RESULT(VK_ERROR_OUT_OF_HOST_MEMORY);
    IBR_RESULT(VK_ERROR_OUT_OF_DEVICE_MEMORY);
    IBR_RESULT(VK_ERROR_INITIALIZATION_FAILED);
    IBR_RESULT(VK_ERROR_DEVICE_LOST);
    IBR_RESULT(VK_ERROR_MEMORY_MAP_FAILED);
    IBR_RESULT(VK_ERROR_LAYER_NOT_PRESENT);
    IBR_RESULT(VK_ERROR_EXTENSION_NOT_PRESENT);
    IBR_RESULT(VK_ERROR_FEATURE_NOT_PRESENT);
    IBR_RESULT(VK_ERROR_INCOMPATIBLE_DRIVER);
    IBR_RESULT(VK_ERROR_TOO_MANY_OBJECTS);
    IBR_RESULT(VK_ERROR_FORMAT_NOT_SUPPORTED);
    IBR_RESULT(VK_ERROR_FRAGMENTED_POOL);
    IBR_RESULT(VK_ERROR_FRAGMENTATION);
    IBR_RESULT(VK_ERROR_OUT_OF_POOL_MEMORY);
    IBR_RESULT(VK_ERROR_SURFACE_LOST_KHR);
    IBR_RESULT(VK_ERROR_OUT_OF_DATE_KHR);
    IBR_RESULT(VK_ERROR_UNKNOWN);
    default:
      return "unknown VkResult";
  }
#undef IBR_RESULT
}

namespace {

ErrorCode errorCode(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_TOO_MANY_OBJECTS:  // from vkAllocateMemory: more allocations than the device allows
      return ErrorCode::outOfMemory;
    case VK_ERROR_DEVICE_LOST:
      return ErrorCode::deviceLost;
    case VK_ERROR_LAYER_NOT_PRESENT:
    case VK_ERROR_EXTENSION_NOT_PRESENT:
    case VK_ERROR_FEATURE_NOT_PRESENT:
    case VK_ERROR_INCOMPATIBLE_DRIVER:
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
      return ErrorCode::unsupported;
    default:
      return ErrorCode::vulkan;
  }
}

}  // namespace

void vk(VkResult result, const char* call) {
  check(result == VK_SUCCESS, errorCode(result), "{}: {} ({})", call, resultName(result), int(result));
}

void vk(const Device& device, VkResult result, const char* call) {
  if (result == VK_ERROR_DEVICE_LOST) device.markLost();
  vk(result, call);
}

void checkAlive(const Device& device, const char* call) {
  if (device.isLost()) vk(VK_ERROR_DEVICE_LOST, call);
}

bool hasInstanceExtension(std::string_view name, const char* layer) {
  std::uint32_t count = 0;
  vk(vkEnumerateInstanceExtensionProperties(layer, &count, nullptr), "vkEnumerateInstanceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  vk(vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data()),
     "vkEnumerateInstanceExtensionProperties");
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name == e.extensionName; });
}

}  // namespace ibr
