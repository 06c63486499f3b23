// SPDX-License-Identifier: Apache-2.0
// Draws the planned meshes into a canvas ([T] §2.5.1, §2.5.2; ARCHITECTURE §5 "Depth", "Tiers").
//
// Ours: best step first, with the depth test on. Step k of n owns the depth range [k, k + kStepDepth] / (n + 1), so a
// better step always wins and true depth decides inside a mesh. The last range stays below 1, the cleared depth, so
// that points at infinity pass too; the gap between ranges keeps infinity of one step apart from the nearest of the
// next. Paper: the same steps in reverse, without depth: what is drawn last wins.
#pragma once

#include <map>

#include "gpu/buffer.h"
#include "gpu/handle.h"
#include "ibr/renderer.h"
#include "render/steps.h"

namespace ibr {

inline constexpr float kStepDepth = 1.0f - 1.0f / 1024.0f;

class CellPass {
 public:
  /// `renderPass`: of the canvas, colour and depth. `views`: the most a plan will have.
  CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass, std::uint32_t views);

  /// Writes all parameters of the frame. Outside a render pass; waits for earlier frames' reads, makes its writes
  /// visible to `draw`.
  void update(VkCommandBuffer commandBuffer, const FramePlan& plan) const noexcept;

  /// Inside the canvas's render pass. Viewport and scissor are set here.
  void draw(VkCommandBuffer commandBuffer, const FramePlan& plan, Order order, std::size_t view,
            VkExtent2D extent) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  struct Variant {
    std::size_t members;
    std::uint32_t panoramas;  // bit i: member i is one
    bool onePage;             // all members' photographs are layers of one image: dithering takes one sample
    bool depth;               // our order
    bool dissolve;            // opacity below 1
    auto operator<=>(const Variant&) const = default;
  };
  VkPipeline pipeline(const FramePlan& plan, const Step& step) const noexcept;
  std::uint32_t firstParameter(Order order, std::size_t view) const noexcept;

  const GpuScene::State* scene_;
  std::uint32_t views_;
  DescriptorSetLayoutHandle frameLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet frameSet_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::map<Variant, PipelineHandle> pipelines_;  // those that the scene's meshes need
  Buffer parameters_, noise_;
};

}  // namespace ibr
