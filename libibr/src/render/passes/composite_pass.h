// SPDX-License-Identifier: Apache-2.0
// Canvas → the caller's image: background, transfer function of the target's format, alpha.
#pragma once

#include <compare>
#include <map>

#include "gpu/device/handle.h"
#include "gpu/draw/canvas.h"
#include "ibr/renderer.h"
#include "render/passes/fill_pass.h"

namespace ibr {

class CompositePass {
 public:
  /// `eyes`: a canvas of two layers that is composed too; `former`: the canvas of the order before a switch; `fill`:
  /// what shows where nothing was drawn. Null: there is none. `hidden`: there is a hidden area.
  CompositePass(Device& device, const Canvas& canvas, const Canvas* eyes, const Canvas* former, const FillPass* fill,
                const RendererOptions& options, bool hidden);

  /// Outside a render pass; the canvas has been ended, the former one where formerWeight > 0, and the fill pass was
  /// recorded where `filled`. `source`: as of FillPass; `drawn`: extent of the canvas's picture.
  /// target.before → target.after; the whole extent is written.
  void record(VkCommandBuffer commandBuffer, std::size_t source, const FramePlan& plan, std::size_t view,
              VkExtent2D drawn, float formerWeight, bool filled, const Target& target) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

  static bool supports(VkFormat format) noexcept;

 private:
  SamplerHandle sampler_, linear_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> sets_;  // by source
  PipelineLayoutHandle layout_;
  struct Key {
    VkFormat format;
    bool former, filled, scaled, floor;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, PipelineHandle> pipelines_;  // those that the options declare
};

}  // namespace ibr
