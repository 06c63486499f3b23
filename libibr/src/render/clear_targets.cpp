// SPDX-License-Identifier: Apache-2.0
#include "render/clear_targets.h"

#include <limits>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/rendering.h"
#include "base/vulkan/target_format.h"

namespace ibr {
namespace {

template <class Target>
void clearColour(VkCommandBuffer commands, VkExtent2D extent, const Target& target, VkClearColorValue value) noexcept {
  transitionTarget(commands, target, target.initialUse, use::kColourAttachment);
  const VkRenderingAttachmentInfo attachment = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, value);
  beginRendering(commands, extent, {&attachment, 1});
  vkCmdEndRendering(commands);
  transitionTarget(commands, target, use::kColourAttachment, target.finalUse);
}

}  // namespace

void clearTarget(VkCommandBuffer commands, const Target& target, glm::vec3 background) noexcept {
  const glm::vec3 colour = writtenColour(background, formatOf(target));
  clearColour(commands, target.extent, target, {{colour.r, colour.g, colour.b, 1.0f}});
  if (!target.depth) return;
  const DepthTarget& depth = *target.depth;
  transitionTarget(commands, depth, depth.initialUse, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  VkRenderingAttachmentInfo attachment =
      depthAttachment(depth.view, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_STORE);
  attachment.clearValue.depthStencil = {depth.reversed ? 0.0f : 1.0f, 0};
  beginRendering(commands, target.extent, {}, &attachment);
  vkCmdEndRendering(commands);
  transitionTarget(commands, depth, use::kDepthAttachment, depth.finalUse, VK_IMAGE_ASPECT_DEPTH_BIT);
}

void clearTargets(VkCommandBuffer commands, const BufferTargets& targets) noexcept {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  clearColour(commands, targets.extent, targets.surface, {{kInfinity, -1, -1, 0}});
  clearColour(commands, targets.extent, targets.weights, {{0, 0, 0, 0}});
  clearColour(commands, targets.extent, targets.confidence, {{0, kInfinity, 0, 0}});
}

}  // namespace ibr
