// SPDX-License-Identifier: Apache-2.0
#include "render/passes/gather_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/canvas.h"
#include "gpu/draw/descriptors.h"
#include "render/passes/cell_pass.h"
#include "render/passes/gather_parameters.h"
#include "shaders/composite_vert.h"
#include "shaders/gather_buffers_frag.h"
#include "shaders/gather_frag.h"
#include "shaders/gather_overlay_frag.h"
#include "shaders/gather_vote_comp.h"
#include "shaders/gather_with_depth_frag.h"

namespace ibr {
namespace {

constexpr VkFormat kSurfacesFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr VkShaderStageFlags kAllStages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
constexpr BufferUse kParametersRead{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
                                        VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                    VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
constexpr ImageUse kRead{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                         VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                         VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
constexpr ImageUse kReadInitial{VK_IMAGE_LAYOUT_UNDEFINED, kRead.stages, kRead.access};

struct Constants {  // specialisation constants of the shaders
  std::int32_t candidates, layers, colours, slots, depthSlots;
  VkBool32 panoramas, exposed, masked, cubic;
  std::uint32_t overlay;
};
constexpr std::array<VkSpecializationMapEntry, 10> kEntries{{{0, offsetof(Constants, candidates), 4},
                                                             {1, offsetof(Constants, layers), 4},
                                                             {2, offsetof(Constants, colours), 4},
                                                             {3, offsetof(Constants, slots), 4},
                                                             {4, offsetof(Constants, depthSlots), 4},
                                                             {5, offsetof(Constants, panoramas), 4},
                                                             {6, offsetof(Constants, exposed), 4},
                                                             {7, offsetof(Constants, masked), 4},
                                                             {8, offsetof(Constants, cubic), 4},
                                                             {9, offsetof(Constants, overlay), 4}}};

VkExtent2D scaled(VkExtent2D extent, double scale) {
  const auto side = [&](std::uint32_t n) { return std::max(1u, std::uint32_t(std::lround(n * scale))); };
  return {side(extent.width), side(extent.height)};
}

DescriptorSetLayoutHandle makeViewLayout(const Device& device) {
  const std::array<VkDescriptorSetLayoutBinding, 5> bindings{{
      {shader::kBindingGatherViews, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kAllStages, nullptr},
      {shader::kBindingGatherAtlas, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
      {shader::kBindingGatherVote, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
      {shader::kBindingGatherVoted, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT,
       nullptr},
      {shader::kBindingGatherHoles, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT,
       nullptr},
  }};
  return makeSetLayout(device, bindings);
}

}  // namespace

GatherPass::GatherPass(const Device& device, const GpuScene& scene, VkRenderPass canvasPass, VkExtent2D largest,
                       const RendererOptions& options, const Requirements& requirements)
    : scene_(&stateOf(scene)), viewLayout_(makeViewLayout(device)) {
  const VkExtent2D voted = scaled(largest, options.voteScale);
  const std::uint32_t candidates = std::clamp(options.gatherCandidates, 1u, kMaxGatherCandidates);
  views_ = Buffer(device, options.maxViews * sizeof(shader::GatherView),
                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device,
                  "candidates of views");
  layers_.emplace(device, *scene_, voted, candidates, viewLayout_.get());
  surfaces_ = GpuImage(
      device,
      {.format = kSurfacesFormat, .extent = voted, .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT},
      "surfaces of the vote");
  const VkImageView surfaces = surfaces_.view();
  holes_.emplace(device, voted, std::span(&surfaces, 1));

  const VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  nearest_ = make<SamplerHandle>(device, vkCreateSampler, nearest, "vkCreateSampler");
  const std::array<VkDescriptorPoolSize, 3> sizes{{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
                                                   {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1},
                                                   {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3}}};
  pool_ = makeDescriptorPool(device, 1, sizes);
  viewSet_ = allocateSet(device, pool_.get(), viewLayout_.get());
  writeStorageBuffer(device, viewSet_, shader::kBindingGatherViews, views_.get());
  writeSampledImage(device, viewSet_, shader::kBindingGatherAtlas, nearest_.get(), layers_->atlas());
  writeStorageImage(device, viewSet_, shader::kBindingGatherVote, surfaces);
  writeSampledImage(device, viewSet_, shader::kBindingGatherVoted, nearest_.get(), surfaces);
  writeSampledImage(device, viewSet_, shader::kBindingGatherHoles, nearest_.get(), holes_->colours().view());

  const VkDescriptorSetLayout viewLayout = viewLayout_.get();
  const VkPushConstantRange voteConstants{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(shader::GatherConstants)};
  voteLayout_ = makePipelineLayout(device, {&viewLayout, 1}, {&voteConstants, 1});
  const std::array<VkDescriptorSetLayout, 2> layouts{viewLayout, scene_->gather->layout()};
  const VkPushConstantRange gatherConstants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(shader::GatherConstants)};
  layout_ = makePipelineLayout(device, layouts, {&gatherConstants, 1});
  Constants constants{std::int32_t(candidates),
                      std::int32_t(std::clamp(options.gatherLayers, 1u, kMaxGatherLayers)),
                      std::int32_t(std::clamp(options.gatherColours, 1u, kMaxGatherColours)),
                      std::int32_t(scene_->gather->photographSlots()),
                      std::int32_t(scene_->gather->depthSlots()),
                      requirements.panoramas > 0,
                      requirements.gains,
                      requirements.masked > 0,
                      scene_->gather->isCubic(),
                      std::uint32_t(Overlay::none)};
  const Specialisation all{kEntries, std::as_bytes(std::span(&constants, 1))};
  vote_ = makeComputePipeline(device, {.name = "vote for depth",
                                       .shader = shaders::gather_vote_comp,
                                       .specialisation = {std::span(kEntries).first(2), all.data},
                                       .layout = voteLayout_.get()});
  gather_ = makeGraphicsPipeline(
      device, {.name = "gather",
               .vertex = shaders::composite_vert,
               .fragment = requirements.depth ? shaders::gather_with_depth_frag : shaders::gather_frag,
               .specialisation = all,
               .layout = layout_.get(),
               .renderPass = canvasPass,
               .depthTest = true,
               .depthWrite = requirements.depth});
  for (const Overlay overlay : requirements.overlays) {
    if (overlay == Overlay::overlap) continue;
    constants.overlay = std::uint32_t(overlay);
    overlays_.emplace(overlay, makeGraphicsPipeline(device, {.name = "gather: overlay",
                                                             .vertex = shaders::composite_vert,
                                                             .fragment = shaders::gather_overlay_frag,
                                                             .specialisation = all,
                                                             .layout = layout_.get(),
                                                             .renderPass = canvasPass,
                                                             .depthTest = true,
                                                             .depthWrite = requirements.depth}));
  }
  if (requirements.buffers)
    buffers_ = makeGraphicsPipeline(device, {.name = "gather: buffers",
                                             .vertex = shaders::composite_vert,
                                             .fragment = shaders::gather_buffers_frag,
                                             .specialisation = all,
                                             .layout = layout_.get(),
                                             .colourFormats = kBufferFormats,
                                             .depthFormat = Canvas::kDepthFormat,
                                             .depthTest = true});
}

VkExtent2D GatherPass::voteExtent(const FramePlan& plan, VkExtent2D extent) const noexcept {
  const VkExtent2D wanted = scaled(extent, plan.settings.voteScale), most = layers_->tile();
  return {std::min(wanted.width, most.width), std::min(wanted.height, most.height)};
}

shader::GatherConstants GatherPass::constants(const FramePlan& plan, std::size_t view, VkExtent2D extent,
                                              std::uint32_t items) const noexcept {
  const VkExtent2D voted = voteExtent(plan, extent), tile = layers_->tile();
  const float slots = float(items + 1);
  return {.extent = {extent.width, extent.height},
          .voteExtent = {voted.width, voted.height},
          .tile = {tile.width, tile.height},
          .view = std::uint32_t(view),
          .depthFirst = float(items) / slots,
          .depthSpan = kStepDepth / slots};
}

void GatherPass::update(VkCommandBuffer commands, const FramePlan& plan, std::size_t view,
                        VkExtent2D extent) const noexcept {
  bufferBarrier(commands, kParametersRead, use::kTransferWrite);
  const shader::GatherView parameters = gatherView(*scene_, plan, view, extent);
  static_assert(sizeof parameters <= 65536);
  vkCmdUpdateBuffer(commands, views_.get(), view * sizeof parameters, sizeof parameters, &parameters);
  bufferBarrier(commands, use::kTransferWrite, kParametersRead);
}

void GatherPass::vote(VkCommandBuffer commands, const FramePlan& plan, std::size_t view,
                      VkExtent2D extent) const noexcept {
  const shader::GatherConstants pushed = constants(plan, view, extent, 0);
  layers_->record(commands, plan, viewSet_, pushed);
  transition(commands, surfaces_.get(), kReadInitial, use::kStorage);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, vote_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, voteLayout_.get(), shader::kSetGatherView, 1,
                          &viewSet_, 0, nullptr);
  vkCmdPushConstants(commands, voteLayout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof pushed, &pushed);
  const auto groups = [](std::uint32_t n) {
    return (n + std::uint32_t(shader::kGatherGroup) - 1) / std::uint32_t(shader::kGatherGroup);
  };
  vkCmdDispatch(commands, groups(pushed.voteExtent.x), groups(pushed.voteExtent.y), 1);
  transition(commands, surfaces_.get(), use::kStorage, kRead);
  holes_->record(commands, {pushed.voteExtent.x, pushed.voteExtent.y}, 0);
}

void GatherPass::draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                      std::uint32_t items) const noexcept {
  drawOver(commands, gather_.get(), plan, view, extent, items);
}

void GatherPass::drawOverlay(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                             std::uint32_t items) const noexcept {
  drawOver(commands, overlays_.at(plan.settings.overlay).get(), plan, view, extent, items);
}

void GatherPass::drawBuffers(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                             std::uint32_t items) const noexcept {
  drawOver(commands, buffers_.get(), plan, view, extent, items);
}

void GatherPass::drawOver(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, std::size_t view,
                          VkExtent2D extent, std::uint32_t items) const noexcept {
  const shader::GatherConstants pushed = constants(plan, view, extent, items);
  const float depth = pushed.depthFirst + 0.5f * pushed.depthSpan;
  const VkViewport viewport{0, 0, float(extent.width), float(extent.height), depth, depth};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &scissor);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  const std::array<VkDescriptorSet, 2> sets{viewSet_, scene_->gather->set()};
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetGatherView,
                          std::uint32_t(sets.size()), sets.data(), 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof pushed, &pushed);
  vkCmdDraw(commands, 3, 1, 0, 0);
}

VkDeviceSize GatherPass::bytes() const noexcept {
  const VkExtent2D extent = surfaces_.info().extent;
  return views_.size() + layers_->bytes() + VkDeviceSize(16) * extent.width * extent.height + holes_->bytes();
}

VkDeviceSize GatherPass::allocatedBytes() const noexcept {
  return views_.allocatedBytes() + layers_->allocatedBytes() + surfaces_.allocatedBytes() + holes_->allocatedBytes();
}

std::uint32_t GatherPass::pipelineCount() const noexcept {
  return GatherLayers::kPipelineCount + FillPass::kPipelineCount + 2 + std::uint32_t(overlays_.size()) +
         (buffers_.get() != VK_NULL_HANDLE);
}

std::uint32_t GatherPass::dispatchCount(const FramePlan& plan, VkExtent2D extent) noexcept {
  return 1 + FillPass::dispatchCount(scaled(extent, plan.settings.voteScale));
}

std::uint64_t GatherPass::triangleCount(const GpuScene::State& scene, const FramePlan& plan) noexcept {
  std::uint64_t count = 0;
  for (const PlannedPhotograph& photograph : plan.photographs)
    count += scene.backdrops[photograph.backdrop].place.indices.count / 3;
  return count;
}

}  // namespace ibr
