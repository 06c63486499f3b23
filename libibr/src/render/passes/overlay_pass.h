// SPDX-License-Identifier: Apache-2.0
// Draws cells as CellPass does, with an overlay over or in place of their colours (shared/overlay.h).
#pragma once

#include <map>

#include "render/passes/cell_pass.h"
#include "render/passes/uncertainties.h"

namespace ibr {

class OverlayPass {
 public:
  /// `renderPass`: of the canvas. `requirements`: of the scene and `options`. `uncertainties`: null if no overlay shows
  /// them. Throws Error{unsupported} if the device cannot read so many vertices in a shader.
  OverlayPass(const Device& device, const CellPass& cells, VkRenderPass renderPass, const RendererOptions& options,
              const Requirements& requirements, const Uncertainties* uncertainties);

  /// Replaces CellPass::draw.
  void draw(VkCommandBuffer commands, const PlanDraws& draws, Order order, std::size_t view,
            VkExtent2D extent) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  struct Key {
    Overlay overlay;
    CellVariant variant;
    bool depth, mapped;
    auto operator<=>(const Key&) const = default;
  };

  void makeSet(const Device& device);
  void require(const Device& device, VkRenderPass renderPass, const Key& key);

  const CellPass* cells_;
  const Uncertainties* uncertainties_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;
};

}  // namespace ibr
