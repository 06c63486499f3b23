// SPDX-License-Identifier: Apache-2.0
// Draws the pixels that a view never shows (RendererOptions::hiddenArea) into a canvas before the cells. They get depth
// 0, so that no draw item passes, and an alpha that later passes recognise (shared/hidden_area.h).
#pragma once

#include <array>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/renderer.h"

namespace ibr {

/// Throws Error{invalidInput} as RendererOptions::hiddenArea documents.
void checkHiddenArea(const std::array<std::vector<glm::vec2>, 2>& triangles);

class HiddenArea {
 public:
  /// `triangles`: by view, not both empty, valid for checkHiddenArea. `renderPass`: of the canvas. `eyesPass`: of the
  /// canvas of both eyes; may be null.
  HiddenArea(const Device& device, const std::array<std::vector<glm::vec2>, 2>& triangles, VkRenderPass renderPass,
             VkRenderPass eyesPass, Uploader& uploader);

  /// Draws one view inside the canvas's render pass, before everything else. Sets viewport and scissor.
  void draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;
  /// Draws both views, inside the render pass of the canvas of both eyes.
  void drawEyes(VkCommandBuffer commands, const FramePlan& plan, VkExtent2D extent) const noexcept;

  std::uint32_t triangleCount(std::size_t view) const noexcept { return counts_[view] / 3; }
  std::uint32_t pipelineCount() const noexcept { return eyes_.get() ? 2 : 1; }
  VkDeviceSize bytes() const noexcept { return corners_.size(); }

 private:
  void record(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, VkExtent2D extent,
              std::uint32_t first, std::uint32_t count) const noexcept;

  std::array<std::uint32_t, 2> counts_{};  // of corners, by view
  Buffer corners_;                         // tangents and view; corners of the first view come first
  PipelineLayoutHandle layout_;
  PipelineHandle single_, eyes_;
};

}  // namespace ibr
