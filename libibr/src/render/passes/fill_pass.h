// SPDX-License-Identifier: Apache-2.0
// Fills empty pixels of an image from their surroundings (shared/fill.h): colours of tier 3, and depth where the vote
// finds no surface. The image is not changed. Filled values are in `colours()`, at half the image's width and height.
// The last level has one texel, so every hole is filled.
#pragma once

#include <span>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

class FillPass {
 public:
  /// `sources`: images of at most `largest` with the alpha of a canvas: isDrawn() of shared/hidden_area.h.
  FillPass(const Device& device, VkExtent2D largest, std::span<const VkImageView> sources);

  /// Outside a render pass. The source must have been drawn as a colour attachment, or made visible to compute shaders.
  /// `extent`: part of the source in use. Leaves colours() in use::kSampled. Waits until the previous frame has read
  /// colours(). `source`: index into `sources`.
  void record(VkCommandBuffer commands, VkExtent2D extent, std::size_t source) const noexcept;

  const GpuImage& colours() const noexcept { return levels_[0]; }
  VkDeviceSize allocatedBytes() const noexcept;
  VkDeviceSize bytes() const noexcept;  // of texels
  static constexpr std::uint32_t kPipelineCount = 3;
  static std::uint32_t dispatchCount(VkExtent2D extent) noexcept;  // of one record()

  /// Extent of the next coarser level.
  static VkExtent2D coarser(VkExtent2D extent) noexcept { return {(extent.width + 1) / 2, (extent.height + 1) / 2}; }

 private:
  void dispatch(VkCommandBuffer commands, VkPipeline pipeline, VkDescriptorSet set, VkExtent2D fine, VkExtent2D coarse,
                VkExtent2D threads) const noexcept;

  std::vector<GpuImage> levels_;  // RGBA16F; the first has half the source's size, the last 1×1
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> pullFirst_;    // by source: writes level 0
  std::vector<VkDescriptorSet> pull_, push_;  // pull_[l] writes level l + 1 from level l; push_[l] the reverse
  PipelineLayoutHandle layout_;
  PipelineHandle pullCanvas_, pullLevel_, pushLevel_;
};

}  // namespace ibr
