// SPDX-License-Identifier: Apache-2.0
#include "render/buffer_pass.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/rendering.h"
#include "gpu/upload.h"
#include "shaders/buffers_frag.h"

namespace ibr {
namespace {

struct Constants {
  float tier, rank, extrapolation;
};

constexpr std::array kBlends{BlendMode::blend};  // colours are told apart, not blended
constexpr std::array kFormats{kSurfaceFormat, kWeightsFormat, kConfidenceFormat};

std::array<const BufferTarget*, 3> all(const BufferTargets& targets) {
  return {&targets.surface, &targets.weights, &targets.confidence};
}

}  // namespace

BufferPass::BufferPass(Device& device, const Scene& scene, const CellPass& cells, const Canvas& canvas,
                       const Requirements& requirements)
    : cells_(&cells), canvas_(&canvas) {
  std::vector<float> uncertainties;
  const auto append = [&](const std::vector<Cell>& meshes, std::vector<VkDeviceSize>& offsets) {
    for (const Cell& cell : meshes) {
      offsets.push_back(uncertainties.size() * sizeof(float));
      uncertainties.insert(uncertainties.end(), cell.mesh.uncertainty.begin(), cell.mesh.uncertainty.end());
    }
  };
  append(scene.cells, cellOffsets_);
  append(scene.backdrops, backdropOffsets_);
  const auto bytes = std::as_bytes(std::span(uncertainties));
  uncertainties_ =
      Buffer(device, std::max<VkDeviceSize>(bytes.size(), 4),
             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device, "uncertainties");
  if (!bytes.empty()) uploadBuffer(device, uncertainties_, 0, bytes);

  const std::array<VkDescriptorSetLayout, 2> sets{cells.frameLayout(), cells.scene().sets.layout()};
  const VkPushConstantRange constants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(Constants)};
  layout_ = makePipelineLayout(device, sets, {&constants, 1});
  const auto require = [&](const GpuScene::State::Mesh& mesh, bool mayDissolve) {
    for (const CellVariant& variant : variantsOf(mesh, mayDissolve, kBlends))
      for (const bool depth : {false, true}) {
        const Key key{variant, depth};
        if (!(depth ? requirements.depthOrder : requirements.painters) || pipelines_.contains(key)) continue;
        pipelines_.emplace(key, makeCellPipeline(device, variant,
                                                 {.name = "buffers",
                                                  .fragment = shaders::buffers_frag,
                                                  .layout = layout_.get(),
                                                  .depth = depth,
                                                  .vertices = CellVertices::withUncertainty,
                                                  .colourFormats = kFormats,
                                                  .depthFormat = Canvas::kDepthFormat}));
      }
  };
  for (const GpuScene::State::Mesh& cell : cells.scene().cells) require(cell, requirements.dissolve);
  for (const GpuScene::State::Mesh& backdrop : cells.scene().backdrops) require(backdrop, requirements.dissolve);
}

void BufferPass::record(VkCommandBuffer commands, const FramePlan& plan, std::size_t view,
                        const BufferTargets& targets) const noexcept {
  constexpr float kUnknown = std::numeric_limits<float>::infinity();
  const float emptyTier = plan.settings.lowestTier >= kTierFilled ? float(kTierFilled) : -1.0f;
  const std::array<VkClearColorValue, 3> empty{
      {{{kUnknown, emptyTier, -1.0f, 0.0f}}, {{0, 0, 0, 0}}, {{0, kUnknown, 0, 0}}}};
  std::array<VkRenderingAttachmentInfo, 3> colours{};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const BufferTarget& target = *all(targets)[i];
    transition(commands, target.image, target.before, use::kColourAttachment);
    colours[i] = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, empty[i]);
  }
  // Left as the canvas leaves it: the frame's passes have read it, the next frame clears it.
  constexpr ImageUse kRead{use::kSampled.layout, use::kSampled.stages | use::kDepthAttachment.stages,
                           use::kSampled.access | use::kDepthAttachment.access};
  transition(commands, canvas_->depth(), kRead, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  const VkRenderingAttachmentInfo depth =
      depthAttachment(canvas_->depthView(), VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE);
  beginRendering(commands, targets.extent, colours, &depth);
  cells_->bind(commands, layout_.get());
  cells_->eachStep(
      commands, plan, Order::current, view, targets.extent, [&](const Step& step, std::uint32_t parameter) {
        const bool backdrop = step.tier == kTierBackdrop;
        const GpuScene::State& scene = cells_->scene();
        const auto mesh = std::size_t(step.mesh - (backdrop ? scene.backdrops : scene.cells).data());
        const Constants constants{float(step.tier), float(step.rank), step.extrapolation};
        const VkBuffer buffer = uncertainties_.get();
        vkCmdBindVertexBuffers(commands, 1, 1, &buffer, &(backdrop ? backdropOffsets_ : cellOffsets_)[mesh]);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                          pipelines_.at({variantOf(step, kBlends[0]), !cells_->isPainters(plan.settings)}).get());
        vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof constants, &constants);
        cells_->drawStep(commands, layout_.get(), step, parameter);
      });
  vkCmdEndRendering(commands);
  transition(commands, canvas_->depth(), use::kDepthAttachment, use::kSampled, VK_IMAGE_ASPECT_DEPTH_BIT);
  for (const BufferTarget* target : all(targets))
    transition(commands, target->image, use::kColourAttachment, target->after);
}

}  // namespace ibr
