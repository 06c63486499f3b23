// SPDX-License-Identifier: Apache-2.0
// Draws a plan's draw items into floating-point images: depth, weights and confidence of every pixel (BufferTargets).
#pragma once

#include <map>

#include "gpu/draw/canvas.h"
#include "render/passes/cell_pass.h"
#include "render/passes/gather_pass.h"
#include "render/passes/uncertainties.h"

namespace ibr {

class BufferPass {
 public:
  /// `canvas`: its depth image serves as depth attachment, once the frame's passes have read it.
  BufferPass(const Device& device, const CellPass& cells, const Uncertainties& uncertainties, const Canvas& canvas,
             const Requirements& requirements);

  /// `gather`: draws pixels without a cell; null: the plan has no gather. Outside a render pass. CellPass::update and
  /// all reads of the canvas's depth must have been recorded before.
  void record(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view, const BufferTargets& targets,
              const GatherPass* gather) const noexcept;

  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()); }

 private:
  struct Key {
    CellVariant variant;
    bool depth;  // DrawOrder::ours
    auto operator<=>(const Key&) const = default;
  };

  const CellPass* cells_;
  const Uncertainties* uncertainties_;
  const Canvas* canvas_;
  PipelineLayoutHandle layout_;
  std::map<Key, PipelineHandle> pipelines_;
};

}  // namespace ibr
