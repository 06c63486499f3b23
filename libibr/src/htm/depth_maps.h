// SPDX-License-Identifier: Apache-2.0
// Depth maps of the mesh from each camera of a harmonised model, for visibility tests.
#pragma once

#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/htm.h"

namespace ibr {

inline constexpr VkFormat kHtmDepthMapFormat = VK_FORMAT_R32_SFLOAT;

class HtmDepthMaps {
 public:
  explicit HtmDepthMaps(const Device& device);

  /// Adds commands that draw every layer of the model's `depths`, after uploads of its mesh. They discard the contents
  /// and wait for earlier reads. Object and model must stay at their addresses until the commands are recorded.
  void draw(const Device& device, const GpuHtmModel::State& model, Uploader& uploader);

 private:
  struct Attachments;
  void record(VkCommandBuffer commands, const GpuHtmModel::State& model, const Attachments& attachments) const noexcept;

  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  PipelineHandle pipeline_;
};

}  // namespace ibr
