// SPDX-License-Identifier: Apache-2.0
// Canvas → the caller's image: background, transfer function of the target's format, alpha.
#pragma once

#include <compare>
#include <map>

#include "gpu/canvas.h"
#include "gpu/handle.h"
#include "ibr/renderer.h"
#include "render/fill_pass.h"

namespace ibr {

class CompositePass {
 public:
  /// `former`: the canvas of the order before a switch; `fill`: what shows where nothing was drawn. Null: there is
  /// none.
  CompositePass(Device& device, const Canvas& canvas, const Canvas* former, const FillPass* fill,
                const RendererOptions& options);

  /// Outside a render pass; the canvas has been ended, the former one where formerWeight > 0, and the fill pass was
  /// recorded where `filled`. target.before → target.after; the whole extent is written.
  /// `drawn`: extent of the canvas's picture.
  void record(VkCommandBuffer commandBuffer, const RenderSettings& settings, VkExtent2D drawn, float formerWeight,
              bool filled, const Target& target) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

  static bool supports(VkFormat format) noexcept;

 private:
  SamplerHandle sampler_, linear_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle layout_;
  struct Key {
    VkFormat format;
    bool former, filled, scaled;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, PipelineHandle> pipelines_;  // those that the options declare
};

}  // namespace ibr
