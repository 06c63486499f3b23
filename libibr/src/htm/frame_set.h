// SPDX-License-Identifier: Apache-2.0
// Descriptor set that all passes of a frame share: the model's buffers and images, and the frame's own buffers.
#pragma once

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "htm/gpu_model.h"
#include "shared/htm.h"

namespace ibr {

class HtmFrameSet {
 public:
  HtmFrameSet(const Device& device, const GpuHtmModel::State& model);

  /// Binds another model, or the same one after a change. Reuses buffers that are large enough; if a buffer cannot be
  /// made, only show() may follow. Commands recorded earlier must have finished.
  void show(const Device& device, const GpuHtmModel::State& model);

  /// Writes the plan's cameras. Waits for earlier frames' reads and makes the writes visible. Outside a render pass.
  /// Precondition: the plan has a camera.
  void update(VkCommandBuffer commands, const HtmFramePlan& plan) const noexcept;

  /// Binds the set and pushes the frame's constants, for compute or graphics pipelines of `layout()`.
  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, const shader::HtmFrame& frame) const noexcept;
  /// Returns the push constants of a plan.
  shader::HtmFrame frame(const HtmFramePlan& plan) const noexcept;

  VkPipelineLayout layout() const noexcept { return layout_.get(); }
  const GpuHtmModel::State& model() const noexcept { return *model_; }
  const Buffer& displacements() const noexcept { return displacements_; }

 private:
  const GpuHtmModel::State* model_;
  Buffer cameras_, ranked_, displacements_, colours_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
};

}  // namespace ibr
