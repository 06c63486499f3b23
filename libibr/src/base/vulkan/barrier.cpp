// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/barrier.h"

#include <cassert>

#include "base/vulkan/functions.h"

namespace ibr {

void transition(VkCommandBuffer commands, VkImage image, ImageUse from, ImageUse to,
                VkImageAspectFlags aspect) noexcept {
  transition(commands, image, from, to, {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS});
}

void transition(VkCommandBuffer commands, VkImage image, ImageUse from, ImageUse to,
                const VkImageSubresourceRange& range) noexcept {
  assert(to.layout != VK_IMAGE_LAYOUT_UNDEFINED);
  const VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                      .srcStageMask = from.stages,
                                      .srcAccessMask = from.access,
                                      .dstStageMask = to.stages,
                                      .dstAccessMask = to.access,
                                      .oldLayout = from.layout,
                                      .newLayout = to.layout,
                                      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                      .image = image,
                                      .subresourceRange = range};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &info);
}

void bufferBarrier(VkCommandBuffer commands, BufferUse from, BufferUse to) noexcept {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = from.stages,
                                 .srcAccessMask = from.access,
                                 .dstStageMask = to.stages,
                                 .dstAccessMask = to.access};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace ibr
