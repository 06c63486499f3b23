// SPDX-License-Identifier: Apache-2.0
// The candidates' meshes, each drawn into a tile of an atlas: what each photograph says of the depth of every pixel
// (shared/gather.h). A mesh is cut where depth jumps.
#pragma once

#include <cstdint>

#include "gpu/device/handle.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/device.h"
#include "ibr/renderer.h"
#include "render/resident/gpu_scene_state.h"
#include "shared/gather.h"

namespace ibr {

class GatherLayers {
 public:
  /// `largest`: of a tile; `viewLayout`: of kSetGatherView. Throws Error{unsupported} where the atlas is larger than an
  /// image of the device.
  GatherLayers(const Device& device, const GpuScene::State& scene, VkExtent2D largest, std::uint32_t candidates,
               VkDescriptorSetLayout viewLayout);

  /// Outside a render pass. Waits for the reads of the frame before; afterwards the atlas can be sampled in compute
  /// shaders.
  void record(VkCommandBuffer commands, const FramePlan& plan, VkDescriptorSet viewSet,
              const shader::GatherConstants& constants) const noexcept;

  VkImageView atlas() const noexcept { return colour_.view(); }
  VkExtent2D tile() const noexcept { return tile_; }
  VkDeviceSize bytes() const noexcept;  // of texels
  VkDeviceSize allocatedBytes() const noexcept { return colour_.allocatedBytes() + depth_.allocatedBytes(); }
  static constexpr std::uint32_t kPipelineCount = 1;

 private:
  const GpuScene::State* scene_;
  VkExtent2D tile_;
  GpuImage colour_, depth_;
  RenderPassHandle renderPass_;
  FramebufferHandle framebuffer_;
  PipelineLayoutHandle layout_;
  PipelineHandle pipeline_;
};

}  // namespace ibr
