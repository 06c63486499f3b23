// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/canvas.h"

#include <cassert>

#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

GpuImage makeImage(const Device& device, VkExtent2D extent, std::uint32_t layers, VkFormat format,
                   VkImageUsageFlags usage, VkImageAspectFlags aspect, const char* name) {
  constexpr VkImageUsageFlags kReads = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  return GpuImage(device,
                  {.format = format,
                   .extent = extent,
                   .layers = layers,
                   .usage = usage | kReads,
                   .aspect = aspect,
                   .viewType = layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D},
                  name);
}

VkAttachmentDescription attachment(VkFormat format) {
  return {.format = format,
          .samples = VK_SAMPLE_COUNT_1_BIT,
          .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
          .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
          .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
          .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
          .finalLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}

RenderPassHandle makeRenderPass(const Device& device, std::uint32_t layers) {
  const VkAttachmentDescription attachments[]{attachment(Canvas::kColourFormat), attachment(Canvas::kDepthFormat)};
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     .colorAttachmentCount = 1,
                                     .pColorAttachments = &colour,
                                     .pDepthStencilAttachment = &depth};

  constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                            VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                            VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkPipelineStageFlags kReading =
      VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  constexpr VkAccessFlags kWrites = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  constexpr VkAccessFlags kReads = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
  const VkSubpassDependency dependencies[]{
      // The previous frame: its draws (write after write) and the readers of its result (write after read, for which an
      // execution dependency is enough).
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = kDrawing | kReading,
       .dstStageMask = kDrawing,
       .srcAccessMask = kWrites,
       .dstAccessMask = kWrites | kReads},
      // Readers of this frame's result.
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = kDrawing,
       .dstStageMask = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
       .srcAccessMask = kWrites,
       .dstAccessMask = VK_ACCESS_SHADER_READ_BIT}};

  constexpr std::uint32_t kBoth = 0b11;
  const VkRenderPassMultiviewCreateInfo views{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_MULTIVIEW_CREATE_INFO,
                                              .subpassCount = 1,
                                              .pViewMasks = &kBoth,
                                              .correlationMaskCount = 1,
                                              .pCorrelationMasks = &kBoth};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .pNext = layers > 1 ? &views : nullptr,
                                    .attachmentCount = 2,
                                    .pAttachments = attachments,
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass,
                                    .dependencyCount = 2,
                                    .pDependencies = dependencies};
  return make<RenderPassHandle>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

}  // namespace

Canvas::Canvas(const Device& device, VkExtent2D largest, VkImageUsageFlags extraUsage, std::uint32_t layers)
    : colour_(makeImage(device, largest, layers, kColourFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | extraUsage,
                        VK_IMAGE_ASPECT_COLOR_BIT, "canvas colour")),
      depth_(makeImage(device, largest, layers, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                       VK_IMAGE_ASPECT_DEPTH_BIT, "canvas depth")),
      renderPass_(makeRenderPass(device, layers)) {
  assert(layers == 1 || layers == 2);
  for (std::uint32_t layer = 0; layers > 1 && layer < layers; ++layer)
    for (const GpuImage* image : {&colour_, &depth_}) layerViews_.push_back(makeLayerView(device, *image, layer));
  const VkImageView views[]{colour_.view(), depth_.view()};
  const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = renderPass_.get(),
                                     .attachmentCount = 2,
                                     .pAttachments = views,
                                     .width = largest.width,
                                     .height = largest.height,
                                     .layers = 1};
  framebuffer_ = make<FramebufferHandle>(device, vkCreateFramebuffer, info, "vkCreateFramebuffer");
  nameObject(device, VK_OBJECT_TYPE_RENDER_PASS, renderPass_.get(), "canvas");
  nameObject(device, VK_OBJECT_TYPE_FRAMEBUFFER, framebuffer_.get(), "canvas");
}

void Canvas::begin(VkCommandBuffer commands, VkExtent2D extent, const std::array<float, 4>& clear) const noexcept {
  assert(extent.width <= largest().width && extent.height <= largest().height);
  VkClearValue values[2]{};
  values[0].color = {{clear[0], clear[1], clear[2], clear[3]}};
  values[1].depthStencil = {1.0f, 0};
  const VkRenderPassBeginInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = renderPass_.get(),
                                   .framebuffer = framebuffer_.get(),
                                   .renderArea = {{0, 0}, extent},
                                   .clearValueCount = 2,
                                   .pClearValues = values};
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
}

void Canvas::end(VkCommandBuffer commands) const noexcept {
  vkCmdEndRenderPass(commands);
}

}  // namespace ibr
