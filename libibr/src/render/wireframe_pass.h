// SPDX-License-Identifier: Apache-2.0
// Cells as CellPass draws them, with their triangles' edges coloured by rank ([T] fig. 4).
#pragma once

#include <map>

#include "render/cell_pass.h"

namespace ibr {

class WireframePass {
 public:
  /// `renderPass`: of the canvas. `requirements`: of the scene and `options`. Throws Error{unsupported} where the
  /// device cannot read so many vertices in a shader.
  WireframePass(const Device& device, const CellPass& cells, VkRenderPass renderPass, const RendererOptions& options,
                const Requirements& requirements);

  /// In place of CellPass::draw.
  void draw(VkCommandBuffer commands, const FramePlan& plan, Order order, std::size_t view,
            VkExtent2D extent) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  struct Key {
    CellVariant variant;
    bool depth, mapped;
    auto operator<=>(const Key&) const = default;
  };

  const CellPass* cells_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;
};

}  // namespace ibr
