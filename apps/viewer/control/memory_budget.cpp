// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/memory_budget.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr::app {
namespace {

bool reportsBudgets(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> all(count);
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data()), "vkEnumerateDeviceExtensionProperties");
  return std::ranges::any_of(
      all, [](const auto& e) { return std::strcmp(e.extensionName, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME) == 0; });
}

std::uint32_t largestLocalHeap(const VkPhysicalDeviceMemoryProperties& memory) {
  std::uint32_t best = 0;
  const auto localBytes = [&](std::uint32_t heap) {
    return memory.memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT ? memory.memoryHeaps[heap].size : 0;
  };
  for (std::uint32_t heap = 1; heap < memory.memoryHeapCount; ++heap)
    if (localBytes(heap) > localBytes(best)) best = heap;
  return best;
}

}  // namespace

MemoryMeter::MemoryMeter(const Device& device)
    : device_(device),
      heap_(largestLocalHeap(device.memoryProperties())),
      reportsBudgets_(reportsBudgets(device.physicalDevice())) {}

MemoryBudget MemoryMeter::read() const {
  if (!reportsBudgets_) return {device_.memoryProperties().memoryHeaps[heap_].size, std::nullopt};
  VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{.sType =
                                                       VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
  VkPhysicalDeviceMemoryProperties2 memory{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
                                           .pNext = &budget};
  vkGetPhysicalDeviceMemoryProperties2(device_.physicalDevice(), &memory);
  return {budget.heapBudget[heap_], budget.heapUsage[heap_]};
}

}  // namespace ibr::app
