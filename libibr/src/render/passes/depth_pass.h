// SPDX-License-Identifier: Apache-2.0
// Writes the scene's depth for the caller's polygons. Departure: [T] §2.5.5 has no such depth, so its polygons cover
// everything.
#pragma once

#include <vector>

#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "render/passes/canvas_source.h"

namespace ibr {

class DepthPass {
 public:
  /// `eyes`: canvas of both eyes, also a source; may be null. `hidden`: the options have a hidden area.
  DepthPass(const Device& device, const Canvas& canvas, const Canvas* eyes, bool hidden);

  /// Outside a render pass, after the canvas has ended. `source`: kFromCanvas or kFromEyes + layer. `items`: draw items
  /// in the canvas with DrawOrder::ours. `drawn`: extent of the image in the canvas. `extent`: of the target, which
  /// gets the depth of the nearest canvas pixel.
  void record(VkCommandBuffer commands, std::size_t source, std::uint32_t items, double nearDistance, VkExtent2D drawn,
              VkExtent2D extent, const DepthTarget& target) const noexcept;

  static bool supports(VkFormat format) noexcept;
  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> sets_;  // by source
  PipelineLayoutHandle layout_;
  std::vector<PipelineHandle> pipelines_;  // one per supported format
};

}  // namespace ibr
