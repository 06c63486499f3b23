// SPDX-License-Identifier: Apache-2.0
// Draws the planned meshes into a canvas ([T] §2.5.1, §2.5.2; ARCHITECTURE §5 "Depth", "Tiers").
//
// Ours: best step first, with the depth test on. Step k of n owns the depth range [k, k + kStepDepth] / (n + 1), so a
// better step always wins and true depth decides inside a mesh. The last range stays below 1, the cleared depth, so
// that points at infinity pass too; the gap between ranges keeps infinity of one step apart from the nearest of the
// next. Paper: the same steps in reverse, without depth: what is drawn last wins.
#pragma once

#include <map>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/passes/cell_pipeline.h"
#include "render/passes/steps.h"

namespace ibr {

inline constexpr float kStepDepth = 1.0f - 1.0f / 1024.0f;

class CellPass {
 public:
  /// `renderPass`: of the canvas, colour and depth. `requirements`: of the scene and `options`.
  /// `eyesPass`: of a canvas for both eyes; null: they are never drawn at once.
  /// `colourTables`: packed entries by slot (render/passes/colour_tables.h); null: colours are never mapped.
  CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass, const RendererOptions& options,
           const Requirements& requirements, VkBuffer colourTables = VK_NULL_HANDLE,
           VkRenderPass eyesPass = VK_NULL_HANDLE);

  /// Writes all parameters of the frame. Outside a render pass; waits for earlier frames' reads, makes its writes
  /// visible to `draw`.
  void update(VkCommandBuffer commandBuffer, const FramePlan& plan) const noexcept;

  /// Inside the canvas's render pass. Viewport and scissor are set here.
  void draw(VkCommandBuffer commandBuffer, const FramePlan& plan, Order order, std::size_t view,
            VkExtent2D extent) const noexcept;
  /// The current order of both views, inside the pass of the canvas for both eyes.
  void drawEyes(VkCommandBuffer commandBuffer, const FramePlan& plan, VkExtent2D extent) const noexcept;

  // For other passes that draw steps, with pipelines of their own (render/passes/cell_pipeline.h) whose layouts begin
  // with frameLayout and that of the scene's PhotographSets.
  VkDescriptorSetLayout frameLayout() const noexcept { return frameLayout_.get(); }
  const GpuScene::State& scene() const noexcept { return *scene_; }
  std::uint32_t firstParameter(Order order, std::size_t view) const noexcept;  // of the first step
  void bind(VkCommandBuffer commandBuffer, VkPipelineLayout layout) const noexcept;
  void drawStep(VkCommandBuffer commandBuffer, VkPipelineLayout layout, const Step& step,
                std::uint32_t parameter) const noexcept;
  /// Whether what is drawn last wins, without depth. A scene with nothing to map has no sequence.
  bool isPainters(const RenderSettings& settings) const noexcept;
  /// Whether a step's colours go through its table.
  bool isMapped(const FramePlan& plan, const Step& step) const noexcept;
  /// Calls draw(step, parameter) for each step that is not hidden, in the plan's order; viewport and scissor are set.
  template <class Draw>
  void eachStep(VkCommandBuffer commandBuffer, const FramePlan& plan, Order order, std::size_t view, VkExtent2D extent,
                const Draw& draw) const noexcept;
  /// As the plan wants it in the canvas.
  VkPipeline pipeline(const FramePlan& plan, const Step& step, bool eyes = false) const noexcept;
  VkPipelineLayout layout() const noexcept { return layout_.get(); }

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }
  VkDeviceSize parameterBytes() const noexcept { return parameters_.size() + exposures_.size(); }
  VkDeviceSize noiseBytes() const noexcept { return noise_.size(); }

 private:
  struct Key {
    CellVariant variant;
    bool depth;   // our order
    bool mapped;  // colours go through their tables
    bool eyes;    // both at once
    auto operator<=>(const Key&) const = default;
  };

  const GpuScene::State* scene_;
  std::uint32_t views_, steps_;  // the most of a plan, and of a picture
  bool mixes_;                   // there is room for the order before a switch
  bool mayMap_;
  DescriptorSetLayoutHandle frameLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet frameSet_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;  // those that the scene's meshes need
  Buffer parameters_, noise_;
  Buffer exposures_;  // empty where no photograph has a gain
};

template <class Draw>
void CellPass::eachStep(VkCommandBuffer commandBuffer, const FramePlan& plan, Order order, std::size_t view,
                        VkExtent2D extent, const Draw& draw) const noexcept {
  const Steps steps = stepsOf(*scene_, plan, order, view);
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetScissor(commandBuffer, 0, 1, &scissor);
  const bool painters = isPainters(plan.settings);
  const float slots = float(steps.count + 1);
  for (std::uint32_t k = 0; k < steps.count; ++k) {
    const std::uint32_t s = painters ? steps.count - 1 - k : k;
    if (steps.step[s].hidden && !painters) continue;
    const VkViewport viewport{
        0, 0, float(extent.width), float(extent.height), float(s) / slots, (float(s) + kStepDepth) / slots};
    vkCmdSetViewport(commandBuffer, 0, 1, &viewport);
    draw(steps.step[s], firstParameter(order, view) + s);
  }
}

}  // namespace ibr
