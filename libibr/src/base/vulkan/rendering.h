// SPDX-License-Identifier: Apache-2.0
// Dynamic rendering (VK_KHR_dynamic_rendering) to images that are already in their attachment layouts.
#pragma once

#include <vulkan/vulkan_core.h>

#include <span>

namespace ibr {

/// Attachment in use::kColourAttachment; the result is stored.
VkRenderingAttachmentInfo colourAttachment(VkImageView view, VkAttachmentLoadOp load,
                                           const VkClearColorValue& cleared = {}) noexcept;
/// Attachment in use::kDepthAttachment; cleared to 1.
VkRenderingAttachmentInfo depthAttachment(VkImageView view, VkAttachmentLoadOp load,
                                          VkAttachmentStoreOp store) noexcept;

/// Begins rendering to the first `extent` pixels of one layer and sets viewport and scissor to them. `depth` may be
/// null. Ended by vkCmdEndRendering.
void beginRendering(VkCommandBuffer commands, VkExtent2D extent, std::span<const VkRenderingAttachmentInfo> colours,
                    const VkRenderingAttachmentInfo* depth = nullptr) noexcept;

/// Sets the viewport (depth range 0 to 1) and the scissor.
void setViewport(VkCommandBuffer commands, VkExtent2D extent) noexcept;

}  // namespace ibr
