// SPDX-License-Identifier: Apache-2.0
// What a view never shows (RendererOptions::hiddenArea), drawn into a canvas before the cells: at depth 0, where no
// step passes, and with an alpha of its own that later passes know (shared/hidden_area.h).
#pragma once

#include <array>
#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "ibr/renderer.h"

namespace ibr {

/// Throws Error{invalidInput} as RendererOptions::hiddenArea says.
void checkHiddenArea(const std::array<std::vector<glm::vec2>, 2>& triangles);

class HiddenArea {
 public:
  /// By view, not both empty, and as checkHiddenArea wants them; `renderPass` of the canvas, `eyesPass` of the one for
  /// both eyes (null: there is none).
  HiddenArea(const Device& device, const std::array<std::vector<glm::vec2>, 2>& triangles, VkRenderPass renderPass,
             VkRenderPass eyesPass);

  /// Inside the canvas's render pass, before all else. Viewport and scissor are set here.
  void draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Both views', inside the pass of the canvas for both eyes.
  void drawEyes(VkCommandBuffer commands, const FramePlan& plan, VkExtent2D extent) const noexcept;

  std::uint32_t triangleCount(std::size_t view) const noexcept { return counts_[view] / 3; }
  std::uint32_t pipelineCount() const noexcept { return eyes_.get() ? 2 : 1; }
  VkDeviceSize bytes() const noexcept { return corners_.size(); }

 private:
  void record(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, VkExtent2D extent,
              std::uint32_t first, std::uint32_t count) const noexcept;

  std::array<std::uint32_t, 2> counts_{};  // of corners, by view
  Buffer corners_;                         // the first view's before the second's: tangents and view
  PipelineLayoutHandle layout_;
  PipelineHandle single_, eyes_;
};

}  // namespace ibr
