// SPDX-License-Identifier: Apache-2.0
// Draws a plan's steps once more, into floats: what is known of every pixel beside its colour (BufferTargets).
#pragma once

#include <map>

#include "gpu/draw/canvas.h"
#include "render/passes/cell_pass.h"
#include "render/passes/gather_pass.h"
#include "render/passes/uncertainties.h"

namespace ibr {

class BufferPass {
 public:
  /// `canvas` lends its depth image between frames' uses.
  BufferPass(const Device& device, const CellPass& cells, const Uncertainties& uncertainties, const Canvas& canvas,
             const Requirements& requirements);

  /// `gather`: draws the rest of the plan; null: it has none. Outside a render pass. CellPass::update has been recorded
  /// for the plan, and what reads the canvas's depth too.
  void record(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, const BufferTargets& targets,
              const GatherPass* gather) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  struct Key {
    CellVariant variant;
    bool depth;  // our order
    auto operator<=>(const Key&) const = default;
  };

  const CellPass* cells_;
  const Uncertainties* uncertainties_;
  const Canvas* canvas_;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;
};

}  // namespace ibr
