// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/memory.h"

#include <bit>
#include <cstdint>

#include "base/check.h"
#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

struct MemoryPreference {
  VkMemoryPropertyFlags required, preferred, unwanted;
};

MemoryPreference preference(MemoryKind kind) {
  constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (kind) {
    case MemoryKind::upload:
      return {kMapped, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
    case MemoryKind::readback:
      return {kMapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    case MemoryKind::device:
      break;
  }
  // Host-visible memory of a discrete GPU is often a small window, best left to other uses.
  return {0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT};
}

/// Best of the allowed types, the first among equals as Vulkan orders them by speed; −1 if there is none.
int memoryType(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
               const MemoryPreference& preference) {
  // Protected, lazily allocated and vendor-specific memory needs features or usages that libibr does not enable.
  constexpr VkMemoryPropertyFlags kOrdinary = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                              VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                              VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  int best = -1, bestScore = 0;
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = memory.memoryTypes[i].propertyFlags;
    if (!(allowed >> i & 1) || (flags & preference.required) != preference.required || (flags & ~kOrdinary)) continue;
    const int score = 4 * std::popcount(flags & preference.preferred) - std::popcount(flags & preference.unwanted);
    if (best < 0 || score > bestScore) {
      best = int(i);
      bestScore = score;
    }
  }
  return best;
}

}  // namespace

MemoryHandle allocate(const Device& device, const VkMemoryRequirements& requirements, MemoryKind kind,
                      std::string_view name) {
  checkAlive(device, "vkAllocateMemory");
  const VkPhysicalDeviceMemoryProperties& memory = device.memoryProperties();
  const int type = memoryType(memory, requirements.memoryTypeBits, preference(kind));
  check(type >= 0, ErrorCode::unsupported, "{}: {} has no suitable memory type", name, device.name());
  const VkDeviceSize heap = memory.memoryHeaps[memory.memoryTypes[type].heapIndex].size;
  check(requirements.size <= heap, ErrorCode::outOfMemory, "{}: {} bytes exceed the {} bytes of the memory heap on {}",
        name, requirements.size, heap, device.name());

  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .allocationSize = requirements.size,
                                  .memoryTypeIndex = std::uint32_t(type)};
  VkDeviceMemory handle = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device.handle(), &info, nullptr, &handle);
  check(result != VK_ERROR_OUT_OF_DEVICE_MEMORY && result != VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory,
        "{}: cannot allocate {} bytes on {} (vkAllocateMemory: {})", name, requirements.size, device.name(),
        resultName(result));
  vk(device, result, "vkAllocateMemory");
  MemoryHandle owner(device.handle(), handle);
  nameObject(device, VK_OBJECT_TYPE_DEVICE_MEMORY, handle, name);
  return owner;
}

}  // namespace ibr
