// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/upload_batch.h"

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"

namespace ibr {

void recordSteps(VkCommandBuffer commandBuffer, std::span<const UploadStep> steps) noexcept {
  constexpr ImageUse kReplaced{VK_IMAGE_LAYOUT_UNDEFINED, use::kAllCommands.stages, VK_ACCESS_2_NONE};
  constexpr ImageUse kReadable{use::kSampled.layout, use::kAllCommands.stages, VK_ACCESS_2_MEMORY_READ_BIT};
  for (const UploadStep& step : steps) {
    for (const UploadStep::ImageRange& begun : step.begun)
      transition(commandBuffer, begun.image, kReplaced, use::kTransferDestination, begun.range);
    if (!step.buffers.empty()) bufferBarrier(commandBuffer, use::kAllCommands, use::kTransferWrite);
    for (const UploadStep::ImageCopy& copy : step.images)
      vkCmdCopyBufferToImage(commandBuffer, copy.from, copy.to, use::kTransferDestination.layout, 1, &copy.region);
    for (const UploadStep::BufferCopy& copy : step.buffers)
      vkCmdCopyBuffer(commandBuffer, copy.from, copy.to, 1, &copy.region);
    if (!step.buffers.empty()) bufferBarrier(commandBuffer, use::kTransferWrite, use::kAllCommands);
    for (const UploadStep::ImageRange& finished : step.finished)
      transition(commandBuffer, finished.image, use::kTransferDestination, kReadable, finished.range);
    if (step.commands) step.commands(commandBuffer);
  }
}

VkDeviceSize UploadBatch::stagingBytes() const noexcept {
  VkDeviceSize bytes = 0;
  for (const Buffer& buffer : staging) bytes += buffer.allocatedBytes();
  return bytes;
}

}  // namespace ibr
