// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/readback.h"

#include <cassert>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"

namespace ibr {

std::vector<std::byte> readImage(const Device& device, VkImage image, VkExtent2D extent, std::uint32_t bytesPerPixel,
                                 ImageUse current, VkImageAspectFlags aspect, std::uint32_t layer,
                                 std::uint32_t level) {
  assert(current.layout != VK_IMAGE_LAYOUT_UNDEFINED);
  const Buffer host(device, VkDeviceSize(extent.width) * extent.height * bytesPerPixel,
                    VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "image readback");
  submitAndWait(device, [&](VkCommandBuffer commands) {
    const VkImageSubresourceRange range{aspect, level, 1, layer, 1};
    transition(commands, image, current, use::kTransferSource, range);
    const VkBufferImageCopy region{.imageSubresource = {aspect, level, layer, 1},
                                   .imageExtent = {extent.width, extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, image, use::kTransferSource.layout, host.get(), 1, &region);
    transition(commands, image, use::kTransferSource, current, range);
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  return {host.mapped().begin(), host.mapped().end()};
}

std::vector<std::byte> readBuffer(const Device& device, const Buffer& buffer) {
  const Buffer host(device, buffer.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "buffer readback");
  submitAndWait(device, [&](VkCommandBuffer commands) {
    bufferBarrier(commands, use::kAllCommands, use::kTransferRead);
    const VkBufferCopy region{0, 0, buffer.size()};
    vkCmdCopyBuffer(commands, buffer.get(), host.get(), 1, &region);
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  return {host.mapped().begin(), host.mapped().end()};
}

}  // namespace ibr
