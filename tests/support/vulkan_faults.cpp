// SPDX-License-Identifier: Apache-2.0
#include "support/vulkan_faults.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "support/vulkan_replacement.h"

namespace ibr::test {
namespace {

struct Faults {
  int left = -1;  // number of calls before the failure; negative: no failure
  VkResult result = VK_SUCCESS;
  bool losing = false, lost = false;
  const char* failed = nullptr;
};
Faults faults;

std::mutex memoryMutex;  // drivers' own threads allocate no device memory, but tests' threads do
DeviceMemory memory;
std::map<VkDeviceMemory, std::uint64_t> allocations;

bool turnComes(const char* call) {
  if (faults.left < 0 || faults.left-- > 0) return false;
  faults.failed = call;
  return true;
}

bool failsNow(const char* call) {
  return !faults.losing && turnComes(call);
}

bool isLost(const char* call) {
  if (faults.losing && turnComes(call)) faults.lost = true;
  return faults.lost;
}

std::function<void(const char*)> queueWatch;

void watched(const char* call) {
  if (queueWatch) queueWatch(call);
}

}  // namespace

void failCall(int n, VkResult result) {
  faults = {.left = n, .result = result};
}
void loseDevice(int n) {
  faults = {.left = n, .result = VK_ERROR_DEVICE_LOST, .losing = true};
}
void failNothing() {
  faults = {.failed = faults.failed};
}
const char* failedCall() {
  return faults.failed;
}

DeviceMemory deviceMemory() {
  const std::lock_guard lock(memoryMutex);
  return memory;
}

void resetMost() {
  const std::lock_guard lock(memoryMutex);
  memory.most = memory.bytes;
}

void watchQueue(std::function<void(const char* call)> watch) {
  queueWatch = std::move(watch);
}

namespace {

#define IBR_MAY_FAIL(name, parameters, arguments)                   \
  IBR_REPLACE(VkResult, name, parameters) {                         \
    return failsNow(#name) ? faults.result : real_##name arguments; \
  }
// A simulated loss leaves the real device running: all other calls, e.g. vkDeviceWaitIdle, are forwarded.
#define IBR_MAY_TELL_OF_LOSS(name, parameters, arguments)                \
  IBR_REPLACE(VkResult, name, parameters) {                              \
    if (failsNow(#name)) return faults.result;                           \
    return isLost(#name) ? VK_ERROR_DEVICE_LOST : real_##name arguments; \
  }
#define IBR_CREATE_MAY_FAIL(name, Info, Object)                                                                    \
  IBR_MAY_FAIL(name, (VkDevice device, const Info* info, const VkAllocationCallbacks* allocation, Object* object), \
               (device, info, allocation, object))

IBR_CREATE_MAY_FAIL(vkCreateBuffer, VkBufferCreateInfo, VkBuffer)
IBR_CREATE_MAY_FAIL(vkCreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
IBR_CREATE_MAY_FAIL(vkCreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
IBR_CREATE_MAY_FAIL(vkCreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
IBR_CREATE_MAY_FAIL(vkCreateFence, VkFenceCreateInfo, VkFence)
IBR_CREATE_MAY_FAIL(vkCreateFramebuffer, VkFramebufferCreateInfo, VkFramebuffer)
IBR_CREATE_MAY_FAIL(vkCreateImage, VkImageCreateInfo, VkImage)
IBR_CREATE_MAY_FAIL(vkCreateImageView, VkImageViewCreateInfo, VkImageView)
IBR_CREATE_MAY_FAIL(vkCreatePipelineCache, VkPipelineCacheCreateInfo, VkPipelineCache)
IBR_CREATE_MAY_FAIL(vkCreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
IBR_CREATE_MAY_FAIL(vkCreateQueryPool, VkQueryPoolCreateInfo, VkQueryPool)
IBR_CREATE_MAY_FAIL(vkCreateRenderPass, VkRenderPassCreateInfo, VkRenderPass)
IBR_CREATE_MAY_FAIL(vkCreateSampler, VkSamplerCreateInfo, VkSampler)
IBR_CREATE_MAY_FAIL(vkCreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)
IBR_MAY_FAIL(vkAllocateCommandBuffers,
             (VkDevice device, const VkCommandBufferAllocateInfo* info, VkCommandBuffer* commands),
             (device, info, commands))
IBR_MAY_FAIL(vkAllocateDescriptorSets,
             (VkDevice device, const VkDescriptorSetAllocateInfo* info, VkDescriptorSet* sets), (device, info, sets))
IBR_MAY_FAIL(vkBeginCommandBuffer, (VkCommandBuffer commands, const VkCommandBufferBeginInfo* info), (commands, info))
IBR_MAY_FAIL(vkBindBufferMemory, (VkDevice device, VkBuffer buffer, VkDeviceMemory bound, VkDeviceSize offset),
             (device, buffer, bound, offset))
IBR_MAY_FAIL(vkBindImageMemory, (VkDevice device, VkImage image, VkDeviceMemory bound, VkDeviceSize offset),
             (device, image, bound, offset))
IBR_MAY_FAIL(vkCreateComputePipelines,
             (VkDevice device, VkPipelineCache cache, std::uint32_t count, const VkComputePipelineCreateInfo* infos,
              const VkAllocationCallbacks* allocation, VkPipeline* pipelines),
             (device, cache, count, infos, allocation, pipelines))
IBR_MAY_FAIL(vkCreateDevice,
             (VkPhysicalDevice physical, const VkDeviceCreateInfo* info, const VkAllocationCallbacks* allocation,
              VkDevice* device),
             (physical, info, allocation, device))
IBR_MAY_FAIL(vkCreateGraphicsPipelines,
             (VkDevice device, VkPipelineCache cache, std::uint32_t count, const VkGraphicsPipelineCreateInfo* infos,
              const VkAllocationCallbacks* allocation, VkPipeline* pipelines),
             (device, cache, count, infos, allocation, pipelines))
IBR_MAY_FAIL(vkCreateInstance,
             (const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocation, VkInstance* instance),
             (info, allocation, instance))
IBR_MAY_FAIL(vkEndCommandBuffer, (VkCommandBuffer commands), (commands))
IBR_MAY_FAIL(vkEnumeratePhysicalDevices, (VkInstance instance, std::uint32_t* count, VkPhysicalDevice* devices),
             (instance, count, devices))
IBR_MAY_FAIL(vkMapMemory,
             (VkDevice device, VkDeviceMemory mapped, VkDeviceSize offset, VkDeviceSize size, VkMemoryMapFlags flags,
              void** data),
             (device, mapped, offset, size, flags, data))
IBR_MAY_FAIL(vkResetCommandPool, (VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags),
             (device, pool, flags))
IBR_MAY_FAIL(vkResetFences, (VkDevice device, std::uint32_t count, const VkFence* fences), (device, count, fences))
IBR_MAY_TELL_OF_LOSS(vkWaitForFences,
                     (VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all, std::uint64_t timeout),
                     (device, count, fences, all, timeout))
IBR_MAY_TELL_OF_LOSS(vkGetQueryPoolResults,
                     (VkDevice device, VkQueryPool pool, std::uint32_t first, std::uint32_t count, std::size_t size,
                      void* data, VkDeviceSize stride, VkQueryResultFlags flags),
                     (device, pool, first, count, size, data, stride, flags))

IBR_REPLACE(VkResult, vkQueueSubmit2, (VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence)) {
  watched("vkQueueSubmit2");
  if (failsNow("vkQueueSubmit2")) return faults.result;
  return isLost("vkQueueSubmit2") ? VK_ERROR_DEVICE_LOST : real_vkQueueSubmit2(queue, count, infos, fence);
}

IBR_REPLACE(VkResult, vkQueueWaitIdle, (VkQueue queue)) {
  watched("vkQueueWaitIdle");
  return real_vkQueueWaitIdle(queue);
}

IBR_REPLACE(VkResult, vkDeviceWaitIdle, (VkDevice device)) {
  watched("vkDeviceWaitIdle");
  return real_vkDeviceWaitIdle(device);
}

IBR_REPLACE(VkResult, vkAllocateMemory,
            (VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* allocation,
             VkDeviceMemory* made)) {
  if (failsNow("vkAllocateMemory")) return faults.result;
  const VkResult result = real_vkAllocateMemory(device, info, allocation, made);
  if (result == VK_SUCCESS) {
    const std::lock_guard lock(memoryMutex);
    allocations[*made] = info->allocationSize;
    memory.bytes += info->allocationSize;
    memory.most = std::max(memory.most, memory.bytes);
    ++memory.count;
  }
  return result;
}

IBR_REPLACE(void, vkFreeMemory, (VkDevice device, VkDeviceMemory freed, const VkAllocationCallbacks* allocation)) {
  {
    const std::lock_guard lock(memoryMutex);
    if (const auto found = allocations.find(freed); found != allocations.end()) {
      memory.bytes -= found->second;
      --memory.count;
      allocations.erase(found);
    }
  }
  real_vkFreeMemory(device, freed, allocation);
}

// Must follow all replacements.
const bool installed = installVulkanReplacements();

}  // namespace
}  // namespace ibr::test
