// SPDX-License-Identifier: Apache-2.0
// Draws the planned cells into the canvas ([T] §2.5.1, §2.5.2; ARCHITECTURE §5 "Depth", "Tiers").
//
// Ours: main cell first, all of tier 0, then all of tier 1, with the depth test on. Step k of the n steps owns the
// depth range [k, k + 1] / (n + 1), so a better cell always wins and true depth decides inside a cell. The last range
// stays below 1, the cleared depth, so that points at infinity pass too. Paper: the same steps in reverse, without
// depth: what is drawn last wins.
#pragma once

#include "gpu/buffer.h"
#include "gpu/handle.h"
#include "ibr/renderer.h"

namespace ibr {

class CellPass {
 public:
  /// `renderPass`: of the canvas, colour and depth.
  CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass);

  /// Writes the cells' parameters. Outside a render pass; waits for earlier frames' reads, makes its writes visible to
  /// `draw`.
  void update(VkCommandBuffer commandBuffer, const FramePlan& plan) const noexcept;

  /// Inside the canvas's render pass. Viewport and scissor are set here.
  void draw(VkCommandBuffer commandBuffer, const FramePlan& plan, VkExtent2D extent) const noexcept;

 private:
  const GpuScene::State* scene_;
  DescriptorSetLayoutHandle frameLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet frameSet_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  PipelineHandle pipeline_[3][2];  // by members − 2, by depth test
  Buffer parameters_, noise_;
};

}  // namespace ibr
