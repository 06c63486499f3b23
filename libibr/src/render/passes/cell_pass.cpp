// SPDX-License-Identifier: Apache-2.0
#include "render/passes/cell_pass.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "image/blue_noise.h"
#include "render/passes/cell_parameters.h"
#include "render/resident/gpu_scene_state.h"
#include "shaders/cell_frag.h"
#include "shared/cell.h"

namespace ibr {
CellPass::CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass, const RendererOptions& options,
                   const Requirements& requirements, Uploader& uploader, VkBuffer colourTables, VkRenderPass eyesPass)
    : scene_(&stateOf(scene)),
      views_(options.maxViews),
      maxItems_(requirements.maxDrawItems),
      crossFades_(requirements.crossFadeOrders),
      mayMap_(colourTables != VK_NULL_HANDLE) {
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const std::uint32_t parameters = firstParameter(crossFades_ ? Order::previous : Order::current, views_);
  parameters_ = Buffer(device, std::max(parameters, 1u) * sizeof(shader::CellParameters), kUsage, MemoryKind::device,
                       "cell parameters");
  if (requirements.gains)
    exposures_ = Buffer(device, std::max(parameters, 1u) * sizeof(shader::CellExposure), kUsage, MemoryKind::device,
                        "exposures");
  if (requirements.noise) {
    const std::vector<std::uint16_t> ranks = blueNoise(shader::kNoiseSize, 1);
    const std::vector<std::uint32_t> noise(ranks.begin(), ranks.end());
    noise_ = Buffer(device, noise.size() * sizeof(std::uint32_t), kUsage, MemoryKind::device, "blue noise");
    uploader.buffer(noise_, 0, std::as_bytes(std::span(noise)));
  }

  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  const std::array<VkDescriptorSetLayoutBinding, 4> bindings{{
      {shader::kBindingParameters, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr},
      {shader::kBindingNoise, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
      {shader::kBindingFrameTables, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
      {shader::kBindingExposures, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
  }};
  frameLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  frameSet_ = allocateSet(device, pool_.get(), frameLayout_.get());
  writeStorageBuffer(device, frameSet_, shader::kBindingParameters, parameters_.get());
  // All bindings of a descriptor set must be valid; bindings that no pipeline reads get an arbitrary buffer.
  writeStorageBuffer(device, frameSet_, shader::kBindingNoise, (requirements.noise ? noise_ : parameters_).get());
  writeStorageBuffer(device, frameSet_, shader::kBindingFrameTables, mayMap_ ? colourTables : parameters_.get());
  writeStorageBuffer(device, frameSet_, shader::kBindingExposures,
                     (requirements.gains ? exposures_ : parameters_).get());

  const std::array<VkDescriptorSetLayout, 2> layouts{frameLayout_.get(), scene_->sets.layout()};
  layout_ = makePipelineLayout(device, layouts, {});
  for (const GpuScene::State::Mesh& cell : scene_->cells)
    for (const CellVariant& variant : variantsOf(cell, options.dissolve, options.blends))
      for (const bool depth : {false, true})
        for (const bool mapped : {false, true})
          for (const bool eyes : {false, true}) {
            const Key key{variant, depth, mapped, eyes};
            if ((mapped && !mayMap_) || (eyes && !eyesPass)) continue;
            if (!(depth ? requirements.depthOrder : requirements.painterOrder) || pipelines_.contains(key)) continue;
            CellPipelineInfo info{"cells", shaders::cell_frag, layout_.get(), renderPass, depth, mapped};
            if (eyes) {
              info.renderPass = eyesPass;
              info.vertices = CellVertices::forBothEyes;
              info.viewStride = maxItems_;
            }
            pipelines_.emplace(key, makeCellPipeline(device, variant, info));
          }
}

std::uint32_t CellPass::firstParameter(Order order, std::size_t view) const noexcept {
  return maxItems_ * (views_ * std::uint32_t(order) + std::uint32_t(view));
}

bool CellPass::isPainters(const RenderSettings& settings) const noexcept {
  return settings.order == DrawOrder::paper || (mayMap_ && (settings.colourMapping == ColourMapping::paper ||
                                                            settings.colourMapping == ColourMapping::paperRedraw));
}

bool CellPass::isMapped(const FramePlan& plan, const DrawItem& item) const noexcept {
  // Most of an image is the main cell, whose table is the identity except during the fade after a switch.
  const bool isIdentity = item.table == kColourSlotCount || (!plan.colour.mainTableFading && !plan.cells.empty() &&
                                                             item.table == plan.cells[0].colourSlot);
  return mayMap_ && plan.settings.colourMapping != ColourMapping::off && !isIdentity;
}

VkPipeline CellPass::pipeline(const FramePlan& plan, const DrawItem& item, bool eyes) const noexcept {
  const Key key{variantOf(item, plan.settings.blend), !isPainters(plan.settings), isMapped(plan, item), eyes};
  return pipelines_.at(key).get();
}

void CellPass::update(VkCommandBuffer commandBuffer, const PlanDraws& draws) const noexcept {
  const FramePlan& plan = draws.plan;
  // vkCmdUpdateBuffer stores data in the command buffer: frames may be recorded ahead, or never be submitted.
  bufferBarrier(commandBuffer, use::kShaderRead, use::kTransferWrite);
  for (const Order order : {Order::current, Order::previous})
    for (std::size_t view = 0; view < plan.views.size(); ++view) {
      if (order == Order::previous && (!crossFades_ || plan.previousWeight <= 0)) continue;
      const DrawList& list = draws.list(order, view);
      assert(list.count <= maxItems_);
      const auto write = [&]<class Parameters>(const Buffer& buffer, const Parameters& parametersOf) {
        using Value = decltype(parametersOf(list.items[0]));
        constexpr std::uint32_t kAtOnce = 65536 / sizeof(Value);
        std::array<Value, kAtOnce> chunk;
        for (std::uint32_t first = 0; first < list.count; first += kAtOnce) {
          const std::uint32_t count = std::min(kAtOnce, list.count - first);
          for (std::uint32_t s = 0; s < count; ++s) chunk[s] = parametersOf(list.items[first + s]);
          vkCmdUpdateBuffer(commandBuffer, buffer.get(), (firstParameter(order, view) + first) * sizeof(Value),
                            count * sizeof(Value), chunk.data());
        }
      };
      write(parameters_, [&](const DrawItem& item) { return cellParameters(plan, view, item); });
      if (exposures_.size() > 0) write(exposures_, [&](const DrawItem& item) { return cellExposure(plan, item); });
    }
  bufferBarrier(commandBuffer, use::kTransferWrite, use::kShaderRead);
}

void CellPass::draw(VkCommandBuffer commandBuffer, const PlanDraws& draws, Order order, std::size_t view,
                    VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  bind(commandBuffer, layout_.get());
  eachItem(commandBuffer, draws, order, view, extent, [&](const DrawItem& item, std::uint32_t parameter) {
    vkCmdBindPipeline(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline(plan, item));
    drawItem(commandBuffer, layout_.get(), item, parameter);
  });
}

void CellPass::drawEyes(VkCommandBuffer commandBuffer, const PlanDraws& draws, VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  bind(commandBuffer, layout_.get());
  // The second view's parameters lie maxItems_ behind the first's: kViewStride of cell_multiview.vert.
  eachItem(commandBuffer, draws, Order::current, 0, extent, [&](const DrawItem& item, std::uint32_t parameter) {
    vkCmdBindPipeline(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline(plan, item, true));
    drawItem(commandBuffer, layout_.get(), item, parameter);
  });
}

void CellPass::bind(VkCommandBuffer commandBuffer, VkPipelineLayout layout) const noexcept {
  vkCmdBindIndexBuffer(commandBuffer, scene_->meshes.indices().get(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdBindDescriptorSets(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, shader::kSetFrame, 1, &frameSet_, 0,
                          nullptr);
}

void CellPass::drawItem(VkCommandBuffer commandBuffer, VkPipelineLayout layout, const DrawItem& item,
                        std::uint32_t parameter) const noexcept {
  vkCmdBindDescriptorSets(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, shader::kSetCell, 1,
                          &item.mesh->photographs, 0, nullptr);
  const VkBuffer vertices = scene_->meshes.vertices().get();
  vkCmdBindVertexBuffers(commandBuffer, 0, 1, &vertices, &item.mesh->place.vertexOffset);
  vkCmdDrawIndexed(commandBuffer, item.mesh->place.indices.count, 1, item.mesh->place.indices.first, 0,
                   parameter);  // gl_InstanceIndex selects the parameters
}

}  // namespace ibr
