// SPDX-License-Identifier: Apache-2.0
// Command buffers submitted without waiting, like those of a program with frames in flight.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "base/vulkan/functions.h"
#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr::test {

/// The caller waits before recording a buffer again and before destruction.
class CommandBuffers {
 public:
  CommandBuffers(const Device& device, std::uint32_t count) : queue_(device.queue()), commands_(count) {
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                           .queueFamilyIndex = device.queueFamily()};
    pool_ = make<CommandPoolHandle>(device, vkCreateCommandPool, poolInfo, "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool_.get(),
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = count};
    vk(vkAllocateCommandBuffers(device.handle(), &info, commands_.data()), "vkAllocateCommandBuffers");
  }

  VkCommandBuffer record(std::size_t index, const std::function<void(VkCommandBuffer)>& recorder) const {
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vk(vkBeginCommandBuffer(commands_[index], &info), "vkBeginCommandBuffer");
    recorder(commands_[index]);
    vk(vkEndCommandBuffer(commands_[index]), "vkEndCommandBuffer");
    return commands_[index];
  }

  void submit(std::size_t index, const std::function<void(VkCommandBuffer)>& recorder) const {
    const VkCommandBufferSubmitInfo commandsInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                 .commandBuffer = record(index, recorder)};
    const VkSubmitInfo2 info{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commandsInfo};
    vk(vkQueueSubmit2(queue_, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
  }

 private:
  VkQueue queue_;
  CommandPoolHandle pool_;
  std::vector<VkCommandBuffer> commands_;
};

}  // namespace ibr::test
