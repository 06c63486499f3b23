// SPDX-License-Identifier: Apache-2.0
// Composes the canvas into the caller's image: background, transfer function of the target's format, alpha.
#pragma once

#include <compare>
#include <map>

#include "base/vulkan/handle.h"
#include "gpu/draw/canvas.h"
#include "ibr/renderer.h"
#include "render/passes/fill_pass.h"

namespace ibr {

class CompositePass {
 public:
  /// `eyes`: canvas of both eyes, also a source. `previous`: canvas of the previous draw order. `fill`: colours of
  /// empty pixels. Each may be null. `hidden`: the options have a hidden area.
  CompositePass(Device& device, const Canvas& canvas, const Canvas* eyes, const Canvas* previous, const FillPass* fill,
                const RendererOptions& options, bool hidden);

  /// Outside a render pass, after the canvas has ended; also the previous canvas if previousWeight > 0, and the fill
  /// pass if `filled`. `source`: kFromCanvas or kFromEyes + layer. `drawn`: extent of the view's image in the canvas.
  /// target.initialUse → target.finalUse; the whole extent is written.
  void record(VkCommandBuffer commandBuffer, std::size_t source, const FramePlan& plan, std::size_t view,
              VkExtent2D drawn, float previousWeight, bool filled, const Target& target) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  SamplerHandle sampler_, linear_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> sets_;  // by source
  PipelineLayoutHandle layout_;
  struct Key {
    TargetFormat format;
    bool previous, filled, scaled, floor;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, PipelineHandle> pipelines_;  // for the combinations that the options declare
};

}  // namespace ibr
