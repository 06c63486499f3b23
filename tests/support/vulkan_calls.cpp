// SPDX-License-Identifier: Apache-2.0
#include "support/vulkan_calls.h"

#include <dlfcn.h>
#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>

namespace ibr::test {
namespace {

std::atomic<int> allocations, frees, submissions, waits;

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

VulkanCalls vulkanCalls() {
  return {allocations, frees, submissions, waits};
}

}  // namespace ibr::test

#define IBR_COUNTED(name, counter, parameters, arguments)        \
  extern "C" VKAPI_ATTR VkResult VKAPI_CALL name parameters {    \
    static const auto real = ibr::test::next<PFN_##name>(#name); \
    ++ibr::test::counter;                                        \
    return real arguments;                                       \
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

extern "C" VKAPI_ATTR void VKAPI_CALL vkFreeMemory(VkDevice device, VkDeviceMemory memory,
                                                   const VkAllocationCallbacks* allocation) {
  static const auto real = ibr::test::next<PFN_vkFreeMemory>("vkFreeMemory");
  if (memory != VK_NULL_HANDLE) ++ibr::test::frees;
  real(device, memory, allocation);
}
