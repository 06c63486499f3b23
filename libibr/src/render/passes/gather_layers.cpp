// SPDX-License-Identifier: Apache-2.0
#include "render/passes/gather_layers.h"

#include <algorithm>
#include <array>

#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "shaders/gather_layer_frag.h"
#include "shaders/gather_layer_vert.h"

namespace ibr {
namespace {

constexpr VkFormat kColourFormat = VK_FORMAT_R32G32_UINT;
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

VkExtent2D atlasExtent(VkExtent2D tile, std::uint32_t candidates) {
  const auto columns = std::min(candidates, std::uint32_t(shader::kGatherColumns));
  return {tile.width * columns, tile.height * ((candidates + columns - 1) / columns)};
}

GpuImage makeImage(const Device& device, VkExtent2D extent, VkFormat format, VkImageUsageFlags usage,
                   VkImageAspectFlags aspect, const char* name) {
  return GpuImage(device, {.format = format, .extent = extent, .usage = usage, .aspect = aspect}, name);
}

VkAttachmentDescription attachment(VkFormat format, VkAttachmentStoreOp store, VkImageLayout finalLayout) {
  return {.format = format,
          .samples = VK_SAMPLE_COUNT_1_BIT,
          .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
          .storeOp = store,
          .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
          .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
          .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
          .finalLayout = finalLayout};
}

RenderPassHandle makeRenderPass(const Device& device) {
  const std::array<VkAttachmentDescription, 2> attachments{
      attachment(kColourFormat, VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL),
      attachment(kDepthFormat, VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL)};
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     .colorAttachmentCount = 1,
                                     .pColorAttachments = &colour,
                                     .pDepthStencilAttachment = &depth};
  constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                            VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                            VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags kWrites = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  constexpr VkAccessFlags kReads = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
  const std::array<VkSubpassDependency, 2> dependencies{{
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = kDrawing | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .dstStageMask = kDrawing,
       .srcAccessMask = kWrites,
       .dstAccessMask = kWrites | kReads},
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = kDrawing,
       .dstStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .srcAccessMask = kWrites,
       .dstAccessMask = VK_ACCESS_SHADER_READ_BIT},
  }};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .attachmentCount = std::uint32_t(attachments.size()),
                                    .pAttachments = attachments.data(),
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass,
                                    .dependencyCount = std::uint32_t(dependencies.size()),
                                    .pDependencies = dependencies.data()};
  return make<RenderPassHandle>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

}  // namespace

GatherLayers::GatherLayers(const Device& device, const GpuScene::State& scene, VkExtent2D largest,
                           std::uint32_t candidates, VkDescriptorSetLayout viewLayout)
    : scene_(&scene),
      tile_(largest),
      colour_(makeImage(device, atlasExtent(largest, candidates), kColourFormat,
                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT, VK_IMAGE_ASPECT_COLOR_BIT,
                        "depths of candidates")),
      depth_(makeImage(device, atlasExtent(largest, candidates), kDepthFormat,
                       VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT, "depth of the atlas")),
      renderPass_(makeRenderPass(device)) {
  const std::array<VkImageView, 2> views{colour_.view(), depth_.view()};
  const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = renderPass_.get(),
                                     .attachmentCount = std::uint32_t(views.size()),
                                     .pAttachments = views.data(),
                                     .width = colour_.info().extent.width,
                                     .height = colour_.info().extent.height,
                                     .layers = 1};
  framebuffer_ = make<FramebufferHandle>(device, vkCreateFramebuffer, info, "vkCreateFramebuffer");
  nameObject(device, VK_OBJECT_TYPE_RENDER_PASS, renderPass_.get(), "depths of candidates");
  nameObject(device, VK_OBJECT_TYPE_FRAMEBUFFER, framebuffer_.get(), "depths of candidates");

  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(shader::GatherConstants)};
  layout_ = makePipelineLayout(device, {&viewLayout, 1}, {&constants, 1});
  const std::array<VkVertexInputBindingDescription, 2> bindings{
      {{0, vertexStride(1), VK_VERTEX_INPUT_RATE_VERTEX}, {1, 2 * sizeof(std::uint16_t), VK_VERTEX_INPUT_RATE_VERTEX}}};
  const std::array<VkVertexInputAttributeDescription, 3> attributes{
      {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}, {1, 0, VK_FORMAT_R32_SFLOAT, 12}, {2, 1, VK_FORMAT_R16G16_UNORM, 0}}};
  pipeline_ = makeGraphicsPipeline(device, {.name = "depths of candidates",
                                            .vertex = shaders::gather_layer_vert,
                                            .fragment = shaders::gather_layer_frag,
                                            .bindings = bindings,
                                            .attributes = attributes,
                                            .layout = layout_.get(),
                                            .renderPass = renderPass_.get(),
                                            .depthTest = true,
                                            .depthWrite = true,
                                            .depthClamp = true});
}

void GatherLayers::record(VkCommandBuffer commands, const FramePlan& plan, VkDescriptorSet viewSet,
                          const shader::GatherConstants& constants) const noexcept {
  const auto count = std::uint32_t(plan.photographs.size());
  const VkExtent2D used = atlasExtent(tile_, count);
  std::array<VkClearValue, 2> clear{};
  clear[1].depthStencil = {1.0f, 0};
  const VkRenderPassBeginInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = renderPass_.get(),
                                   .framebuffer = framebuffer_.get(),
                                   .renderArea = {{0, 0}, used},
                                   .clearValueCount = std::uint32_t(clear.size()),
                                   .pClearValues = clear.data()};
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
  vkCmdBindIndexBuffer(commands, scene_->meshes.indices().get(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetGatherView, 1, &viewSet,
                          0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, &constants);
  for (std::uint32_t k = 0; k < count; ++k) {
    const GpuScene::State::Mesh& mesh = scene_->backdrops[plan.photographs[k].backdrop];
    const IndexRange& range = mesh.place.indices;
    if (range.count == 0) continue;
    const VkOffset2D corner{std::int32_t(k % std::uint32_t(shader::kGatherColumns) * tile_.width),
                            std::int32_t(k / std::uint32_t(shader::kGatherColumns) * tile_.height)};
    const VkViewport viewport{
        float(corner.x), float(corner.y), float(constants.voteExtent.x), float(constants.voteExtent.y), 0, 1};
    const VkRect2D scissor{corner, {constants.voteExtent.x, constants.voteExtent.y}};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &scissor);
    const std::array<VkBuffer, 2> buffers{scene_->meshes.vertices().get(), scene_->meshes.evidence().get()};
    const std::array<VkDeviceSize, 2> offsets{mesh.place.vertexOffset, mesh.place.evidenceOffset};
    vkCmdBindVertexBuffers(commands, 0, std::uint32_t(buffers.size()), buffers.data(), offsets.data());
    vkCmdDrawIndexed(commands, range.count, 1, range.first, 0, k);
  }
  vkCmdEndRenderPass(commands);
}

VkDeviceSize GatherLayers::bytes() const noexcept {
  return VkDeviceSize(8 + 4) * colour_.info().extent.width * colour_.info().extent.height;
}

}  // namespace ibr
