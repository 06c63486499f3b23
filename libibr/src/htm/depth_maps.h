// SPDX-License-Identifier: Apache-2.0
// Depth maps of the mesh from each camera of a harmonised model, for visibility tests.
#pragma once

#include "base/vulkan/handle.h"
#include "ibr/htm.h"

namespace ibr {

inline constexpr VkFormat kHtmDepthMapFormat = VK_FORMAT_R32_SFLOAT;

class HtmDepthMaps {
 public:
  explicit HtmDepthMaps(const Device& device);

  /// Draws every layer of the model's `depths`, discarding the contents; submits and waits.
  void draw(const Device& device, const GpuHtmModel::State& model);

 private:
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  PipelineHandle pipeline_;
};

}  // namespace ibr
