// SPDX-License-Identifier: Apache-2.0
// Dynamic rendering (VK_KHR_dynamic_rendering) to images that are already in their attachments' layouts.
#pragma once

#include <vulkan/vulkan_core.h>

#include <span>

namespace ibr {

/// In use::kColourAttachment; what is drawn is kept.
VkRenderingAttachmentInfo colourAttachment(VkImageView view, VkAttachmentLoadOp load,
                                           const VkClearColorValue& cleared = {}) noexcept;
/// In use::kDepthAttachment; cleared to 1.
VkRenderingAttachmentInfo depthAttachment(VkImageView view, VkAttachmentLoadOp load,
                                          VkAttachmentStoreOp store) noexcept;

/// Begins rendering to the first `extent` pixels of one layer, viewport and scissor the same. `depth` may be null.
/// vkCmdEndRendering ends it.
void beginRendering(VkCommandBuffer commands, VkExtent2D extent, std::span<const VkRenderingAttachmentInfo> colours,
                    const VkRenderingAttachmentInfo* depth = nullptr) noexcept;

/// Viewport, of all depths, and scissor.
void setViewport(VkCommandBuffer commands, VkExtent2D extent) noexcept;

}  // namespace ibr
