// SPDX-License-Identifier: Apache-2.0
#include "render/passes/buffer_pass.h"

#include <array>
#include <cassert>
#include <limits>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "shaders/buffers_frag.h"

namespace ibr {
namespace {

struct Constants {
  float rank, extrapolation;
};

constexpr std::array kBlends{BlendMode::blend};  // colours are output member by member, not blended

std::array<const BufferTarget*, 3> all(const BufferTargets& targets) {
  return {&targets.surface, &targets.weights, &targets.confidence};
}

}  // namespace

BufferPass::BufferPass(const Device& device, const CellPass& cells, const Uncertainties& uncertainties,
                       const Canvas& canvas, const Requirements& requirements)
    : cells_(&cells), uncertainties_(&uncertainties), canvas_(&canvas) {
  const std::array<VkDescriptorSetLayout, 2> sets{cells.frameLayout(), cells.scene().sets.layout()};
  const VkPushConstantRange constants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(Constants)};
  layout_ = makePipelineLayout(device, sets, {&constants, 1});
  for (const GpuScene::State::Mesh& cell : cells.scene().cells)
    for (const CellVariant& variant : variantsOf(cell, requirements.dissolve, kBlends))
      for (const bool depth : {false, true}) {
        const Key key{variant, depth};
        if (!(depth ? requirements.depthOrder : requirements.painterOrder) || pipelines_.contains(key)) continue;
        pipelines_.emplace(key, makeCellPipeline(device, variant,
                                                 {.name = "buffers",
                                                  .fragment = shaders::buffers_frag,
                                                  .layout = layout_.get(),
                                                  .depth = depth,
                                                  .vertices = CellVertices::withUncertainty,
                                                  .colourFormats = kBufferFormats,
                                                  .depthFormat = Canvas::kDepthFormat}));
      }
}

void BufferPass::record(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view,
                        const BufferTargets& targets, const GatherPass* gather) const noexcept {
  const FramePlan& plan = draws.plan;
  constexpr float kUnknown = std::numeric_limits<float>::infinity();
  const float emptyTier = plan.settings.maxTier >= kTierFilled ? float(kTierFilled) : -1.0f;
  const std::array<VkClearColorValue, 3> empty{
      {{{kUnknown, emptyTier, -1.0f, 0.0f}}, {{0, 0, 0, 0}}, {{0, kUnknown, 0, 0}}}};
  std::array<VkRenderingAttachmentInfo, 3> colours{};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const BufferTarget& target = *all(targets)[i];
    transitionTarget(commands, target, target.initialUse, use::kColourAttachment);
    colours[i] = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, empty[i]);
  }
  // The depth image is in the state that Canvas::end leaves: the frame's passes have read it, the next frame clears it.
  constexpr ImageUse kRead{use::kSampled.layout, use::kSampled.stages | use::kDepthAttachment.stages,
                           use::kSampled.access | use::kDepthAttachment.access};
  transition(commands, canvas_->depth(), kRead, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  const VkRenderingAttachmentInfo depth =
      depthAttachment(canvas_->depthView(), VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE);
  beginRendering(commands, targets.extent, colours, &depth);
  cells_->bind(commands, layout_.get());
  cells_->eachItem(
      commands, draws, Order::current, view, targets.extent, [&](const DrawItem& item, std::uint32_t parameter) {
        const Constants constants{float(item.rank), item.extrapolation};
        const VkBuffer buffer = uncertainties_->get();
        const VkDeviceSize offset = uncertainties_->offset(*item.mesh);
        vkCmdBindVertexBuffers(commands, 1, 1, &buffer, &offset);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                          pipelines_.at({variantOf(item, kBlends[0]), !cells_->isPainters(plan.settings)}).get());
        vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof constants, &constants);
        cells_->drawItem(commands, layout_.get(), item, parameter);
      });
  if (gather) gather->drawBuffers(commands, plan, view, targets.extent, draws.list(Order::current, view).count);
  vkCmdEndRendering(commands);
  transition(commands, canvas_->depth(), use::kDepthAttachment, use::kSampled, VK_IMAGE_ASPECT_DEPTH_BIT);
  for (const BufferTarget* target : all(targets))
    transitionTarget(commands, *target, use::kColourAttachment, target->finalUse);
}

}  // namespace ibr
