// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/frame_slot.h"

#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {

FrameSlot makeFrameSlot(const Device& device) {
  FrameSlot slot;
  slot.pool = make<CommandPoolHandle>(device, vkCreateCommandPool,
                                      VkCommandPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                              .queueFamilyIndex = device.queueFamily()},
                                      "vkCreateCommandPool");
  const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = slot.pool.get(),
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
  vk(vkAllocateCommandBuffers(device.handle(), &allocate, &slot.commands), "vkAllocateCommandBuffers");
  slot.done = make<FenceHandle>(
      device, vkCreateFence,
      VkFenceCreateInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT},
      "vkCreateFence");
  return slot;
}

void beginCommands(const Device& device, const FrameSlot& slot) {
  vk(vkResetCommandPool(device.handle(), slot.pool.get(), 0), "vkResetCommandPool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  vk(vkBeginCommandBuffer(slot.commands, &info), "vkBeginCommandBuffer");
}

}  // namespace ibr
