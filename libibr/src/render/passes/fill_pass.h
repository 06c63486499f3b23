// SPDX-License-Identifier: Apache-2.0
// Tier 3: colours for what is still empty, from what is around it (shared/fill.h). The canvas is not changed; the
// composition takes its empty pixels from `colours()`, which has half the canvas's width and height.
#pragma once

#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/device.h"
#include "render/passes/canvas_source.h"

namespace ibr {

class FillPass {
 public:
  /// `eyes`: a canvas of two layers that is filled too; null: there is none.
  FillPass(const Device& device, const Canvas& canvas, const Canvas* eyes = nullptr);

  /// Outside a render pass, after the canvas was ended; `extent` as it was begun with. `source`: kFromCanvas, or
  /// kFromEyes and the layer. Afterwards colours() is in
  /// use::kSampled. Waits for the frame before it to have read them.
  void record(VkCommandBuffer commands, VkExtent2D extent, std::size_t source = kFromCanvas) const noexcept;

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

  std::vector<GpuImage> levels_;  // RGBA16F; the first has half the canvas's size, the last 1×1
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> pullFirst_;    // by source: writes level 0
  std::vector<VkDescriptorSet> pull_, push_;  // pull_[l] writes level l + 1 from l; push_[l] the other way
  PipelineLayoutHandle layout_;
  PipelineHandle pullCanvas_, pullLevel_, pushLevel_;
};

}  // namespace ibr
