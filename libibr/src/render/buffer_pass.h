// SPDX-License-Identifier: Apache-2.0
// Draws a plan's steps once more, into floats: what is known of every pixel beside its colour (BufferTargets).
#pragma once

#include <map>
#include <vector>

#include "gpu/canvas.h"
#include "render/cell_pass.h"

namespace ibr {

class BufferPass {
 public:
  /// `scene`: what the cells were made of; read here only. `canvas` lends its depth image between frames' uses.
  BufferPass(Device& device, const Scene& scene, const CellPass& cells, const Canvas& canvas,
             const Requirements& requirements);

  /// Outside a render pass. CellPass::update has been recorded for the plan, and what reads the canvas's depth too.
  void record(VkCommandBuffer commands, const FramePlan& plan, std::size_t view,
              const BufferTargets& targets) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }
  VkDeviceSize bytes() const noexcept { return uncertainties_.size(); }
  VkDeviceSize allocatedBytes() const noexcept { return uncertainties_.allocatedBytes(); }

 private:
  struct Key {
    CellVariant variant;
    bool depth;  // our order
    auto operator<=>(const Key&) const = default;
  };

  const CellPass* cells_;
  const Canvas* canvas_;
  Buffer uncertainties_;                                     // of ρ, one a vertex
  std::vector<VkDeviceSize> cellOffsets_, backdropOffsets_;  // bytes of a mesh's first
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;
};

}  // namespace ibr
