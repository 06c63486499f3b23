// SPDX-License-Identifier: Apache-2.0
// Canvas → the caller's image: background, transfer function of the target's format, alpha.
#pragma once

#include "gpu/canvas.h"
#include "gpu/handle.h"
#include "ibr/renderer.h"

namespace ibr {

class CompositePass {
 public:
  CompositePass(Device& device, const Canvas& canvas);

  /// Outside a render pass; the canvas has been ended. target.before → target.after; the whole extent is written.
  void record(VkCommandBuffer commandBuffer, const RenderSettings& settings, const Target& target) const noexcept;

  static bool supports(VkFormat format) noexcept;

 private:
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::vector<PipelineHandle> pipelines_;  // one a supported format
};

}  // namespace ibr
