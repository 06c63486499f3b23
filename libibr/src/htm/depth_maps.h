// SPDX-License-Identifier: Apache-2.0
// The mesh's depth as each camera of a harmonised model sees it, for who sees what.
#pragma once

#include "gpu/device/handle.h"
#include "ibr/htm.h"

namespace ibr {

inline constexpr VkFormat kHtmDepthMapFormat = VK_FORMAT_R32_SFLOAT;

class HtmDepthMaps {
 public:
  explicit HtmDepthMaps(const Device& device);

  /// Draws into every layer of the model's `depths`, whatever they held, submits and waits.
  void draw(const Device& device, const GpuHtmModel::State& model);

 private:
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  PipelineHandle pipeline_;
};

}  // namespace ibr
