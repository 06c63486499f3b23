// SPDX-License-Identifier: Apache-2.0
// Draws the planned meshes into a canvas ([T] §2.5.1, §2.5.2).
//
// DrawOrder::ours: best draw item first, with depth test. DrawItem k of n owns the depth range [k, k + kStepDepth] /
// (n + 1): a better item always wins, and inside a mesh true depth decides. The last range stays below 1, the cleared
// depth, so that points at infinity pass too. A gap between ranges separates infinity of one item from the nearest
// depth of the next. DrawOrder::paper: the same items in reverse without depth; the last drawn wins.
#pragma once

#include <map>

#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/passes/cell_pipeline.h"
#include "render/passes/draw_list.h"

namespace ibr {

inline constexpr float kStepDepth = 1.0f - 1.0f / 1024.0f;

class CellPass {
 public:
  /// `renderPass`: of the canvas, colour and depth. `requirements`: of the scene and `options`.
  /// `eyesPass`: of the canvas of both eyes; null: the two views are never drawn together.
  /// `colourTables`: packed entries by slot (render/passes/colour_tables.h); null: colours are never mapped.
  CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass, const RendererOptions& options,
           const Requirements& requirements, Uploader& uploader, VkBuffer colourTables = VK_NULL_HANDLE,
           VkRenderPass eyesPass = VK_NULL_HANDLE);

  /// Writes all parameters of the frame. Outside a render pass. Waits for reads of earlier frames and makes the writes
  /// visible to `draw`.
  void update(VkCommandBuffer commandBuffer, const PlanDraws& draws) const noexcept;

  /// Draws one view inside the canvas's render pass. Sets viewport and scissor.
  void draw(VkCommandBuffer commandBuffer, const PlanDraws& draws, Order order, std::size_t view,
            VkExtent2D extent) const noexcept;
  /// Draws the current order of both views, inside the render pass of the canvas of both eyes.
  void drawEyes(VkCommandBuffer commandBuffer, const PlanDraws& draws, VkExtent2D extent) const noexcept;

  // For other passes that draw these items with their own pipelines (render/passes/cell_pipeline.h). Their pipeline
  // layouts begin with frameLayout and the layout of the scene's PhotographSets.
  VkDescriptorSetLayout frameLayout() const noexcept { return frameLayout_.get(); }
  const GpuScene::State& scene() const noexcept { return *scene_; }
  std::uint32_t firstParameter(Order order, std::size_t view) const noexcept;  // of the first draw item
  void bind(VkCommandBuffer commandBuffer, VkPipelineLayout layout) const noexcept;
  void drawItem(VkCommandBuffer commandBuffer, VkPipelineLayout layout, const DrawItem& item,
                std::uint32_t parameter) const noexcept;
  /// True if the last drawn item wins, without depth. The paper's sequence counts only if there are colour tables.
  bool isPainters(const RenderSettings& settings) const noexcept;
  /// True if the item's colours go through its colour table.
  bool isMapped(const FramePlan& plan, const DrawItem& item) const noexcept;
  /// Calls draw(item, parameter) for each item that is not hidden, in draw order, with viewport and scissor set.
  template <class Draw>
  void eachItem(VkCommandBuffer commandBuffer, const PlanDraws& draws, Order order, std::size_t view, VkExtent2D extent,
                const Draw& draw) const noexcept;
  /// Returns the pipeline that draws the item into the canvas.
  VkPipeline pipeline(const FramePlan& plan, const DrawItem& item, bool eyes = false) const noexcept;
  VkPipelineLayout layout() const noexcept { return layout_.get(); }

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }
  VkDeviceSize parameterBytes() const noexcept { return parameters_.size() + exposures_.size(); }
  VkDeviceSize noiseBytes() const noexcept { return noise_.size(); }

 private:
  struct Key {
    CellVariant variant;
    bool depth;   // DrawOrder::ours
    bool mapped;  // colours go through colour tables
    bool eyes;    // both views in one render pass
    auto operator<=>(const Key&) const = default;
  };

  const GpuScene::State* scene_;
  std::uint32_t views_, maxItems_;  // maximum numbers of views of a plan and of items of a draw list
  bool crossFades_;                 // parameters have room for the previous order
  bool mayMap_;
  DescriptorSetLayoutHandle frameLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet frameSet_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;  // for the variants that the scene's meshes need
  Buffer parameters_, noise_;
  Buffer exposures_;  // empty if no photograph has a gain
};

template <class Draw>
void CellPass::eachItem(VkCommandBuffer commandBuffer, const PlanDraws& draws, Order order, std::size_t view,
                        VkExtent2D extent, const Draw& draw) const noexcept {
  const DrawList& list = draws.list(order, view);
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetScissor(commandBuffer, 0, 1, &scissor);
  const bool painterOrder = isPainters(draws.plan.settings);
  const float slots = float(list.count + 1);
  for (std::uint32_t k = 0; k < list.count; ++k) {
    const std::uint32_t s = painterOrder ? list.count - 1 - k : k;
    if (list.items[s].hidden && !painterOrder) continue;
    const VkViewport viewport{
        0, 0, float(extent.width), float(extent.height), float(s) / slots, (float(s) + kStepDepth) / slots};
    vkCmdSetViewport(commandBuffer, 0, 1, &viewport);
    draw(list.items[s], firstParameter(order, view) + s);
  }
}

}  // namespace ibr
