// SPDX-License-Identifier: Apache-2.0
// Composition::gathered and hybrid: depth by vote, then colours of what the canvas has nothing on (shared/gather.h).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/passes/fill_pass.h"
#include "render/passes/gather_layers.h"

namespace ibr {

/// Of BufferTargets.
inline constexpr std::array kBufferFormats{kSurfaceFormat, kWeightsFormat, kConfidenceFormat};

class GatherPass {
 public:
  /// `largest`: of the image as it is drawn; `canvasPass`: colour and depth.
  GatherPass(const Device& device, const GpuScene& scene, VkRenderPass canvasPass, VkExtent2D largest,
             const RendererOptions& options, const Requirements& requirements);

  /// Writes the parameters of a view, drawn at `extent`. Outside a render pass; waits for earlier frames' reads.
  void update(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Finds the surfaces of a view; after update(), outside a render pass.
  void vote(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Inside the canvas's pass, after what comes first. `steps`: how many draw items that pass has; the gather takes the
  /// slice of the depth range behind them.
  void draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
            std::uint32_t steps) const noexcept;

  /// As draw(), with a plan's overlay: one of RendererOptions::overlays, but not Overlay::overlap.
  void drawOverlay(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                   std::uint32_t steps) const noexcept;

  /// The same into a plan's BufferTargets, within their rendering (render/passes/buffer_pass.h).
  void drawBuffers(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                   std::uint32_t steps) const noexcept;

  VkDeviceSize bytes() const noexcept;  // of texels and parameters
  VkDeviceSize allocatedBytes() const noexcept;
  std::uint32_t pipelineCount() const noexcept;
  static std::uint32_t dispatchCount(const FramePlan& plan, VkExtent2D extent) noexcept;             // of vote()
  static std::uint64_t triangleCount(const GpuScene::State& scene, const FramePlan& plan) noexcept;  // of vote()

 private:
  void drawOver(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, std::size_t view,
                VkExtent2D extent, std::uint32_t steps) const noexcept;
  VkExtent2D voteExtent(const FramePlan& plan, VkExtent2D extent) const noexcept;
  shader::GatherConstants constants(const FramePlan& plan, std::size_t view, VkExtent2D extent,
                                    std::uint32_t steps) const noexcept;

  const GpuScene::State* scene_;
  double voteScale_;  // the largest
  Buffer views_;
  DescriptorSetLayoutHandle viewLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet viewSet_ = VK_NULL_HANDLE;
  SamplerHandle nearest_;
  std::optional<GatherLayers> layers_;
  GpuImage surfaces_;  // of the vote
  std::optional<FillPass> holes_;
  PipelineLayoutHandle voteLayout_, layout_;
  PipelineHandle vote_, gather_;
  std::map<Overlay, PipelineHandle> overlays_;  // of Requirements::overlays
  PipelineHandle buffers_;                      // none without Requirements::buffers
};

}  // namespace ibr
