// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/rendering.h"

#include <cstdint>

#include "base/vulkan/functions.h"
#include "ibr/target.h"

namespace ibr {

VkRenderingAttachmentInfo colourAttachment(VkImageView view, VkAttachmentLoadOp load,
                                           const VkClearColorValue& cleared) noexcept {
  return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
          .imageView = view,
          .imageLayout = use::kColourAttachment.layout,
          .loadOp = load,
          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
          .clearValue = {.color = cleared}};
}

VkRenderingAttachmentInfo depthAttachment(VkImageView view, VkAttachmentLoadOp load,
                                          VkAttachmentStoreOp store) noexcept {
  return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
          .imageView = view,
          .imageLayout = use::kDepthAttachment.layout,
          .loadOp = load,
          .storeOp = store,
          .clearValue = {.depthStencil = {1.0f, 0}}};
}

void beginRendering(VkCommandBuffer commands, VkExtent2D extent, std::span<const VkRenderingAttachmentInfo> colours,
                    const VkRenderingAttachmentInfo* depth) noexcept {
  const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .renderArea = {{0, 0}, extent},
                                  .layerCount = 1,
                                  .colorAttachmentCount = std::uint32_t(colours.size()),
                                  .pColorAttachments = colours.data(),
                                  .pDepthAttachment = depth};
  setViewport(commands, extent);
  vkCmdBeginRendering(commands, &rendering);
}

void setViewport(VkCommandBuffer commands, VkExtent2D extent) noexcept {
  const VkViewport viewport{0, 0, float(extent.width), float(extent.height), 0, 1};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &scissor);
}

}  // namespace ibr
