// SPDX-License-Identifier: Apache-2.0
// The scene's real depth for the caller's polygons ([T] §2.5.5, which has none: there polygons stand before
// everything).
#pragma once

#include <vector>

#include "gpu/device/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "render/passes/canvas_source.h"

namespace ibr {

class DepthPass {
 public:
  /// `eyes`: a canvas of two layers that is read too; null: there is none. `hidden`: there is a hidden area.
  DepthPass(const Device& device, const Canvas& canvas, const Canvas* eyes, bool hidden);

  /// Outside a render pass; the canvas has been ended. `source`: as of FillPass; `steps`: how many were drawn into it
  /// with our order; `drawn`: extent of the canvas's picture; `extent`: of the target, which takes the nearest.
  void record(VkCommandBuffer commands, std::size_t source, std::uint32_t steps, double nearDistance, VkExtent2D drawn,
              VkExtent2D extent, const DepthTarget& target) const noexcept;

  static bool supports(VkFormat format) noexcept;
  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> sets_;  // by source
  PipelineLayoutHandle layout_;
  std::vector<PipelineHandle> pipelines_;  // one a supported format
};

}  // namespace ibr
