// SPDX-License-Identifier: Apache-2.0
//
// Overlap is counted by additive blending: each cell adds one colour to a pixel, even if its mesh folds there. So each
// cell has one constant depth, nearer than that of the item before it: only its first triangle at a pixel passes.
#include "render/passes/overlay_pass.h"

#include <array>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "shaders/overlay_frag.h"
#include "shared/cell.h"
#include "shared/overlay.h"

namespace ibr {
namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

static_assert(std::uint32_t(Overlay::wireframe) == shader::kOverlayWireframe &&
              std::uint32_t(Overlay::tiers) == shader::kOverlayTiers &&
              std::uint32_t(Overlay::weights) == shader::kOverlayWeights &&
              std::uint32_t(Overlay::confidence) == shader::kOverlayConfidence &&
              std::uint32_t(Overlay::depth) == shader::kOverlayDepth &&
              std::uint32_t(Overlay::overlap) == shader::kOverlayOverlap &&
              std::uint32_t(Overlay::agreement) == shader::kOverlayAgreement);

// True if the overlay shows the image's own colours, too.
bool showsPicture(Overlay overlay) {
  return overlay == Overlay::wireframe || overlay == Overlay::tiers || overlay == Overlay::weights;
}

// Viewport with an item's constant depth for the overlap. It lies behind all regular depths, so DepthPass reads far.
VkViewport flat(VkExtent2D extent, std::uint32_t item) {
  const float share = 1.0f - float(item + 1) / float(kMaxDrawItemCount + 1);
  const float depth = kStepDepth + 0.4f * (1.0f - kStepDepth) * share;
  return {0, 0, float(extent.width), float(extent.height), depth, depth};
}

}  // namespace

OverlayPass::OverlayPass(const Device& device, const CellPass& cells, VkRenderPass renderPass,
                         const RendererOptions& options, const Requirements& requirements,
                         const Uncertainties* uncertainties)
    : cells_(&cells), uncertainties_(uncertainties) {
  makeSet(device);
  const GpuScene::State& scene = cells.scene();
  const std::array<VkDescriptorSetLayout, 3> sets{cells.frameLayout(), scene.sets.layout(), setLayout_.get()};
  const VkPushConstantRange constants{kStages, 0, sizeof(shader::OverlayConstants)};
  layout_ = makePipelineLayout(device, sets, {&constants, 1});
  for (const Overlay overlay : requirements.overlays)
    for (const GpuScene::State::Mesh& cell : scene.cells)
      for (const CellVariant& variant : variantsOf(cell, requirements.dissolve, options.blends))
        for (const bool depth : {false, true})
          for (const bool mapped : {false, true}) {
            if (mapped && !(requirements.colourTables && showsPicture(overlay))) continue;
            if (overlay == Overlay::overlap ? !depth : !(depth ? requirements.depthOrder : requirements.painterOrder))
              continue;
            require(device, renderPass, {overlay, variant, depth, mapped});
          }
}

void OverlayPass::makeSet(const Device& device) {
  const GpuScene::State& scene = cells_->scene();
  const std::uint32_t most = device.properties().limits.maxStorageBufferRange;
  const Buffer &vertices = scene.meshes.vertices(), &indices = scene.meshes.indices();
  check(vertices.size() <= most && indices.size() <= most, ErrorCode::unsupported,
        "overlay: vertices of {} bytes or indices of {} bytes exceed the storage buffer limit of {} ({} bytes)",
        vertices.size(), indices.size(), device.name(), most);
  // Bindings that no pipeline reads get an arbitrary buffer.
  const std::array<VkBuffer, 3> buffers{vertices.get(), indices.get(),
                                        uncertainties_ ? uncertainties_->get() : vertices.get()};
  std::array<VkDescriptorSetLayoutBinding, buffers.size()> bindings;
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr};
  setLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  set_ = allocateSet(device, pool_.get(), setLayout_.get());
  for (std::uint32_t i = 0; i < buffers.size(); ++i) writeStorageBuffer(device, set_, i, buffers[i]);
}

void OverlayPass::require(const Device& device, VkRenderPass renderPass, const Key& key) {
  if (pipelines_.contains(key)) return;
  pipelines_.emplace(key, makeCellPipeline(device, key.variant,
                                           {.name = "overlay",
                                            .fragment = shaders::overlay_frag,
                                            .layout = layout_.get(),
                                            .renderPass = renderPass,
                                            .depth = key.depth,
                                            .mapped = key.mapped,
                                            .vertices = CellVertices::fetched,
                                            .overlay = key.overlay}));
}

void OverlayPass::draw(VkCommandBuffer commands, const PlanDraws& draws, Order order, std::size_t view,
                       VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  const Overlay overlay = plan.settings.overlay;
  const auto ranks = float(order == Order::current ? plan.cells.size() : plan.previous.size());
  std::uint32_t drawn = 0;
  cells_->bind(commands, layout_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetMeshes, 1, &set_, 0,
                          nullptr);
  cells_->eachItem(commands, draws, order, view, extent, [&](const DrawItem& item, std::uint32_t parameter) {
    const VkDeviceSize uncertainty = uncertainties_ ? uncertainties_->offset(*item.mesh) / sizeof(float) : 0;
    const shader::OverlayConstants constants{item.mesh->place.indices.first,
                                             std::uint32_t(item.mesh->place.vertexOffset / 4),
                                             std::uint32_t(uncertainty),
                                             float(item.rank),
                                             ranks,
                                             item.cell != kNoCell};
    const bool counts = overlay == Overlay::overlap;
    const Key key{overlay, variantOf(item, plan.settings.blend), counts || !cells_->isPainters(plan.settings),
                  showsPicture(overlay) && cells_->isMapped(plan, item)};
    if (const VkViewport viewport = flat(extent, drawn++); counts) vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.at(key).get());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetCell, 1,
                            &item.mesh->photographs, 0, nullptr);
    vkCmdPushConstants(commands, layout_.get(), kStages, 0, sizeof constants, &constants);
    vkCmdDraw(commands, item.mesh->place.indices.count, 1, 0, parameter);
  });
}

}  // namespace ibr
