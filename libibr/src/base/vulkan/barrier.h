// SPDX-License-Identifier: Apache-2.0
// Barriers between two named uses (VK_KHR_synchronization2). No tracking: the caller knows the previous use.
#pragma once

#include <vulkan/vulkan_core.h>

#include "ibr/target.h"

namespace ibr {

/// Stages and accesses of one use of buffers. Images: ImageUse in ibr/target.h.
struct BufferUse {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};

namespace use {
inline constexpr BufferUse kTransferRead{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr BufferUse kTransferWrite{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr BufferUse kShaderRead{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                       VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
inline constexpr BufferUse kComputeReadWrite{
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
inline constexpr BufferUse kHostRead{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
inline constexpr BufferUse kAllCommands{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                        VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
}  // namespace use

/// `to.layout` is not UNDEFINED; `from` = kUndefined discards the contents. Covers all levels and layers.
void transition(VkCommandBuffer commands, VkImage image, ImageUse from, ImageUse to,
                VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT) noexcept;

/// As above, for a part of the image.
void transition(VkCommandBuffer commands, VkImage image, ImageUse from, ImageUse to,
                const VkImageSubresourceRange& range) noexcept;

/// As above, for a caller's Target, DepthTarget or BufferTarget: one level and layer.
template <class AnyTarget>
void transitionTarget(VkCommandBuffer commands, const AnyTarget& target, ImageUse from, ImageUse to,
                      VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT) noexcept {
  transition(commands, target.image, from, to, VkImageSubresourceRange{aspect, 0, 1, target.layer, 1});
}

/// Orders accesses to all buffers: drivers treat a global memory barrier no worse than a buffer barrier.
void bufferBarrier(VkCommandBuffer commands, BufferUse from, BufferUse to) noexcept;

}  // namespace ibr
