// SPDX-License-Identifier: Apache-2.0
// Values for what is still empty in an image, from what is around it (shared/fill.h): colours of tier 3, and depth
// where no photograph votes. The image is not changed; empty pixels are taken from `colours()`, which has half its
// width and height.
#pragma once

#include <span>
#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/device.h"

namespace ibr {

class FillPass {
 public:
  /// `sources`: images of at most `largest` whose alpha is that of a canvas: isDrawn() of shared/hidden_area.h.
  FillPass(const Device& device, VkExtent2D largest, std::span<const VkImageView> sources);

  /// Outside a render pass, after the source was drawn as a colour attachment, or written by a shader and made visible
  /// to compute shaders; `extent`: what of it was. Afterwards colours() is in use::kSampled. Waits for the frame before
  /// it to have read them.
  void record(VkCommandBuffer commands, VkExtent2D extent, std::size_t source) const noexcept;

  const GpuImage& colours() const noexcept { return levels_[0]; }
  VkDeviceSize allocatedBytes() const noexcept;
  VkDeviceSize bytes() const noexcept;  // of texels
  static constexpr std::uint32_t kPipelineCount = 3;
  static std::uint32_t dispatchCount(VkExtent2D extent) noexcept;  // of one recording

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
  std::vector<VkDescriptorSet> pull_, push_;  // pull_[l] writes level l + 1 from l; push_[l] the other way
  PipelineLayoutHandle layout_;
  PipelineHandle pullCanvas_, pullLevel_, pushLevel_;
};

}  // namespace ibr
