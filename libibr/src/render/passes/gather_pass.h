// SPDX-License-Identifier: Apache-2.0
// Composition::gathered and hybrid: a vote for depth, then colours for pixels without a cell (shared/gather.h).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/passes/fill_pass.h"
#include "render/passes/gather_layers.h"

namespace ibr {

/// Formats of BufferTargets, in the order of the attachments.
inline constexpr std::array kBufferFormats{kSurfaceFormat, kWeightsFormat, kConfidenceFormat};

class GatherPass {
 public:
  /// `largest`: of a view's image as it is drawn. `canvasPass`: colour and depth.
  GatherPass(const Device& device, const GpuScene& scene, VkRenderPass canvasPass, VkExtent2D largest,
             const RendererOptions& options, const Requirements& requirements);

  /// Writes the parameters of a view drawn at `extent`. Outside a render pass; waits for reads of earlier frames.
  void update(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Finds the surfaces of a view. After update(), outside a render pass.
  void vote(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Draws inside the canvas's render pass, after all other items. `items`: number of draw items in the pass; the
  /// gather owns the slice of the depth range behind them.
  void draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
            std::uint32_t items) const noexcept;

  /// As draw(), with the plan's overlay: one of RendererOptions::overlays, except Overlay::overlap.
  void drawOverlay(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                   std::uint32_t items) const noexcept;

  /// As draw(), into a plan's BufferTargets, inside the rendering of render/passes/buffer_pass.h.
  void drawBuffers(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                   std::uint32_t items) const noexcept;

  VkDeviceSize bytes() const noexcept;  // of texels and parameters
  VkDeviceSize allocatedBytes() const noexcept;
  std::uint32_t pipelineCount() const noexcept;
  static std::uint32_t dispatchCount(const FramePlan& plan, VkExtent2D extent) noexcept;             // of vote()
  static std::uint64_t triangleCount(const GpuScene::State& scene, const FramePlan& plan) noexcept;  // of vote()

 private:
  void drawOver(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, std::size_t view,
                VkExtent2D extent, std::uint32_t items) const noexcept;
  VkExtent2D voteExtent(const FramePlan& plan, VkExtent2D extent) const noexcept;
  shader::GatherConstants constants(const FramePlan& plan, std::size_t view, VkExtent2D extent,
                                    std::uint32_t items) const noexcept;

  const GpuScene::State* scene_;
  Buffer views_;
  DescriptorSetLayoutHandle viewLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet viewSet_ = VK_NULL_HANDLE;
  SamplerHandle nearest_;
  std::optional<GatherLayers> layers_;
  GpuImage surfaces_;  // result of the vote
  std::optional<FillPass> holes_;
  PipelineLayoutHandle voteLayout_, layout_;
  PipelineHandle vote_, gather_;
  std::map<Overlay, PipelineHandle> overlays_;  // by Requirements::overlays
  PipelineHandle buffers_;                      // null without Requirements::buffers
};

}  // namespace ibr
