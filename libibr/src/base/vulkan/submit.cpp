// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/submit.h"

#include <cstdint>

#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"

namespace ibr {

VkResult waitIdle(const Device& device) {
  const QueueLock lock(device);
  const VkResult result = vkDeviceWaitIdle(device.handle());
  if (result == VK_ERROR_DEVICE_LOST) device.markLost();
  return result;
}

Submission::Submission(const Device& device) : device_(&device) {
  const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                         .queueFamilyIndex = device.queueFamily()};
  pool_ = make<CommandPoolHandle>(device, vkCreateCommandPool, poolInfo, "vkCreateCommandPool");
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool_.get(),
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  vk(vkAllocateCommandBuffers(device.handle(), &info, &commands_), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fenceInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  fence_ = make<FenceHandle>(device, vkCreateFence, fenceInfo, "vkCreateFence");
  nameObject(device, VK_OBJECT_TYPE_COMMAND_BUFFER, commands_, "submission");
}

void Submission::run(const std::function<void(VkCommandBuffer)>& record) {
  const VkDevice device = device_->handle();
  checkAlive(*device_, "vkQueueSubmit2");
  vk(vkResetCommandPool(device, pool_.get(), 0), "vkResetCommandPool");
  const VkCommandBufferBeginInfo beginInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  vk(vkBeginCommandBuffer(commands_, &beginInfo), "vkBeginCommandBuffer");
  record(commands_);
  vk(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");

  const VkFence fence = fence_.get();
  vk(vkResetFences(device, 1, &fence), "vkResetFences");
  const VkCommandBufferSubmitInfo commandsInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                               .commandBuffer = commands_};
  const VkSubmitInfo2 info{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commandsInfo};
  {
    const QueueLock lock(*device_);
    vk(*device_, vkQueueSubmit2(device_->queue(), 1, &info, fence), "vkQueueSubmit2");
  }
  const VkResult result = vkWaitForFences(device, 1, &fence, VK_TRUE, UINT64_MAX);
  // Callers may destroy their objects as soon as this throws, so the queue must be idle by then.
  if (result != VK_SUCCESS) {
    const QueueLock lock(*device_);
    vkQueueWaitIdle(device_->queue());
  }
  vk(*device_, result, "vkWaitForFences");
}

void submitAndWait(const Device& device, const std::function<void(VkCommandBuffer)>& record) {
  Submission(device).run(record);
}

}  // namespace ibr
