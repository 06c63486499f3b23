// SPDX-License-Identifier: Apache-2.0
// The scene's real depth for the caller's polygons ([T] §2.5.5, which has none: there polygons stand before
// everything).
#pragma once

#include <vector>

#include "gpu/canvas.h"
#include "gpu/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"

namespace ibr {

class DepthPass {
 public:
  DepthPass(const Device& device, const Canvas& canvas);

  /// Outside a render pass; the canvas has been ended. `steps`: how many were drawn into it with our order.
  /// `drawn`: extent of the canvas's picture; `extent`: of the target, which takes the nearest.
  void record(VkCommandBuffer commands, std::uint32_t steps, double nearDistance, VkExtent2D drawn, VkExtent2D extent,
              const DepthTarget& target) const noexcept;

  static bool supports(VkFormat format) noexcept;
  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::vector<PipelineHandle> pipelines_;  // one a supported format
};

}  // namespace ibr
