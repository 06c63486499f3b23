// SPDX-License-Identifier: Apache-2.0
#include "support/vulkan_calls.h"

#include <atomic>
#include <cstdint>

#include "support/vulkan_replacement.h"

namespace ibr::test {
namespace {

std::atomic<int> allocations, frees, submissions, waits;

#define IBR_COUNTED(name, counter, parameters, arguments) \
  IBR_REPLACE(VkResult, name, parameters) {               \
    ++counter;                                            \
    return real_##name arguments;                         \
  }

IBR_COUNTED(vkAllocateMemory, allocations,
            (VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* allocation,
             VkDeviceMemory* memory),
            (device, info, allocation, memory))
IBR_COUNTED(vkQueueSubmit, submissions, (VkQueue queue, std::uint32_t count, const VkSubmitInfo* infos, VkFence fence),
            (queue, count, infos, fence))
IBR_COUNTED(vkQueueSubmit2, submissions,
            (VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence),
            (queue, count, infos, fence))
IBR_COUNTED(vkQueueWaitIdle, waits, (VkQueue queue), (queue))
IBR_COUNTED(vkDeviceWaitIdle, waits, (VkDevice device), (device))
IBR_COUNTED(vkWaitForFences, waits,
            (VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all, std::uint64_t timeout),
            (device, count, fences, all, timeout))

IBR_REPLACE(void, vkFreeMemory, (VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* allocation)) {
  if (memory != VK_NULL_HANDLE) ++frees;
  real_vkFreeMemory(device, memory, allocation);
}

// Must follow all replacements.
const bool installed = installVulkanReplacements();

}  // namespace

VulkanCalls vulkanCalls() {
  return {allocations, frees, submissions, waits};
}

}  // namespace ibr::test
