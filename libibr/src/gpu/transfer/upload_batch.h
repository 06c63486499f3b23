// SPDX-License-Identifier: Apache-2.0
// Collected uploads: staging memory, and the commands that copy from it.
#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>
#include <span>
#include <vector>

#include "base/vulkan/buffer.h"
#include "ibr/device.h"
#include "ibr/uploads.h"

namespace ibr {

/// Copies in any order, then other commands. Steps are ordered among themselves.
struct UploadStep {
  struct ImageRange {
    VkImage image;
    VkImageSubresourceRange range;
  };
  struct ImageCopy {
    VkBuffer from;
    VkImage to;
    VkBufferImageCopy region;
  };
  struct BufferCopy {
    VkBuffer from, to;
    VkBufferCopy region;
  };

  std::vector<ImageRange> begun;     // discarded, then in use::kTransferDestination
  std::vector<ImageRange> finished;  // in use::kSampled after the copies
  std::vector<ImageCopy> images;
  std::vector<BufferCopy> buffers;
  std::function<void(VkCommandBuffer)> commands;  // does not throw; owns temporary objects; may be empty
};

/// Records the steps outside a render pass. Waits for earlier commands, and makes buffers and images visible to all
/// later commands on the queue.
void recordSteps(VkCommandBuffer commandBuffer, std::span<const UploadStep> steps) noexcept;

struct UploadBatch {
  std::vector<Buffer> staging;
  std::vector<UploadStep> steps;

  VkDeviceSize stagingBytes() const noexcept;
};

struct Uploads::State {
  VkDevice device;
  UploadBatch batch;
};

Uploads::State& stateOf(Uploads& uploads) noexcept;

}  // namespace ibr
