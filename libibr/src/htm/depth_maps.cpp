// SPDX-License-Identifier: Apache-2.0
#include "htm/depth_maps.h"

#include <array>
#include <memory>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "gpu/draw/descriptors.h"
#include "htm/gpu_model.h"
#include "htm/projection.h"
#include "shaders/htm_depth_frag.h"
#include "shaders/htm_depth_vert.h"
#include "shared/htm.h"

namespace ibr {
namespace {

constexpr VkFormat kNearestFormat = VK_FORMAT_D32_SFLOAT;
constexpr ImageUse kRead{use::kSampled.layout, use::kSampled.stages | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                         use::kSampled.access};

}  // namespace

HtmDepthMaps::HtmDepthMaps(const Device& device) {
  const std::array<VkDescriptorSetLayoutBinding, 2> bindings{
      {{shader::kBindingHtmPositions, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr},
       {shader::kBindingHtmTriangles, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr}}};
  setLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  set_ = allocateSet(device, pool_.get(), setLayout_.get());
  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(shader::HtmFrame)};
  const VkDescriptorSetLayout layouts[]{setLayout_.get()};
  layout_ = makePipelineLayout(device, layouts, {&constants, 1});
  pipeline_ = makeGraphicsPipeline(device, {.name = "camera depths",
                                            .vertex = shaders::htm_depth_vert,
                                            .fragment = shaders::htm_depth_frag,
                                            .layout = layout_.get(),
                                            .colourFormats = {&kHtmDepthMapFormat, 1},
                                            .depthFormat = kNearestFormat,
                                            .depthTest = true,
                                            .depthWrite = true});
}

struct HtmDepthMaps::Attachments {
  GpuImage nearest;                    // depth of one layer at a time
  std::vector<ImageViewHandle> views;  // of the layers of `depths`
};

void HtmDepthMaps::draw(const Device& device, const GpuHtmModel::State& model, Uploader& uploader) {
  writeStorageBuffer(device, set_, shader::kBindingHtmPositions, model.positions.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmTriangles, model.triangles.get());
  const auto attachments = std::make_shared<Attachments>();
  attachments->nearest = GpuImage(device,
                                  {.format = kNearestFormat,
                                   .extent = model.depths.info().extent,
                                   .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                   .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
                                  "nearest surface of a harmonised model");
  for (std::uint32_t i = 0; i < model.cameras.size(); ++i)
    attachments->views.push_back(makeLayerView(device, model.depths, i));
  uploader.commands([this, &model, attachments](VkCommandBuffer commands) { record(commands, model, *attachments); });
}

void HtmDepthMaps::record(VkCommandBuffer commands, const GpuHtmModel::State& model,
                          const Attachments& attachments) const noexcept {
  constexpr ImageUse kReadEarlier{VK_IMAGE_LAYOUT_UNDEFINED, kRead.stages, VK_ACCESS_2_NONE};
  constexpr ImageUse kDrawnEarlier{VK_IMAGE_LAYOUT_UNDEFINED, use::kDepthAttachment.stages,
                                   use::kDepthAttachment.access};
  const VkImage depths = model.depths.get(), nearest = attachments.nearest.get();
  transition(commands, depths, kReadEarlier, use::kColourAttachment);
  transition(commands, nearest, kDrawnEarlier, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set_, 0, nullptr);
  for (std::size_t i = 0; i < attachments.views.size(); ++i) {
    const Intrinsics& k = model.cameras[i].intrinsics;
    const VkRenderingAttachmentInfo inverseDepth =
        colourAttachment(attachments.views[i].get(), VK_ATTACHMENT_LOAD_OP_CLEAR);  // clears to 0: infinitely far
    const VkRenderingAttachmentInfo depth =
        depthAttachment(attachments.nearest.view(), VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE);
    beginRendering(commands, model.depths.info().extent, {&inverseDepth, 1}, &depth);
    setViewport(commands, {std::uint32_t(k.width), std::uint32_t(k.height)});
    shader::HtmFrame frame{};
    frame.clip = htmClip(htmProjection(model.cameras[i], model.bounds.middle), k, model.nearDistance[i]);
    vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof frame, &frame);
    if (model.triangleCount > 0) vkCmdDraw(commands, 3 * model.triangleCount, 1, 0, 0);
    vkCmdEndRendering(commands);
    transition(commands, nearest, use::kDepthAttachment, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  }
  transition(commands, depths, use::kColourAttachment, kRead);
}

}  // namespace ibr
