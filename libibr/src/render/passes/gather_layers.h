// SPDX-License-Identifier: Apache-2.0
// Draws the mesh of each candidate photograph into a tile of an atlas: each photograph's hypothesis of every pixel's
// depth (shared/gather.h). A mesh is cut where depth jumps.
#pragma once

#include <cstdint>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/renderer.h"
#include "render/resident/gpu_scene_state.h"
#include "shared/gather.h"

namespace ibr {

class GatherLayers {
 public:
  /// `largest`: of a tile. `viewLayout`: of kSetGatherView. Throws Error{unsupported} if the atlas is larger than the
  /// device's largest image.
  GatherLayers(const Device& device, const GpuScene::State& scene, VkExtent2D largest, std::uint32_t candidates,
               VkDescriptorSetLayout viewLayout);

  /// Outside a render pass. Waits for reads of the previous frame, and makes the atlas visible to compute shaders.
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
