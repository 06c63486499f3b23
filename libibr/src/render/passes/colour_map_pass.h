// SPDX-License-Identifier: Apache-2.0
// Maps the colours of a frame's cells ([T] §2.5.3): ColourMapping::ours, and the paper's sequence.
//
// Ours: a small image of tier 0 of each cell, the proxy, is drawn first, as tiles side by side in the canvas. Textures
// have the detail of the full image. One compute pass counts raw colours by owner, one workgroup makes all tables, and
// the cell pass applies the tables. The canvas has room for the tiles, so the proxy needs no memory of its own.
//
// Paper: front to back, cell by cell: copy the framebuffer, count or write in a fragment stage, make a table, and apply
// the table by compute over all pixels or by redraw. Meshes, textures, filters and culling are the same as in ours.
// Histograms count pixels of cells; filled pixels are not part of them. Only the first view is counted; a second view
// is drawn with the tables of the first ([T] §2.5.4).
#pragma once

#include <map>
#include <optional>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "gpu/draw/canvas.h"
#include "ibr/renderer.h"
#include "render/passes/cell_pass.h"
#include "render/passes/colour_tables.h"

namespace ibr {

class ColourMapPass {
 public:
  /// Usage flags that the canvas's colour image needs for this support.
  static constexpr VkImageUsageFlags canvasUse(ColourSupport support) {
    return support == ColourSupport::all ? VK_IMAGE_USAGE_STORAGE_BIT : 0;
  }

  /// All arguments must outlive the pass. Precondition: the options' colour support is not off.
  ColourMapPass(Device& device, ColourTables& tables, const CellPass& cells, const Canvas& canvas,
                const RendererOptions& options);

  /// Ours: makes the frame's tables, after CellPass::update. Leaves the canvas's render pass ended and its contents
  /// undefined. Outside a render pass. `extent`: of the view's image in the canvas. Called for the first view, or for
  /// each view if the views have separate tables.
  void makeTables(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view, VkExtent2D extent) const noexcept;

  /// Paper: makes the tables and draws the first view, from Canvas::begin to the state that Canvas::end leaves.
  void drawSequence(VkCommandBuffer commands, const PlanDraws& draws, VkExtent2D extent) const noexcept;

  /// Adds the cost of these passes beyond one pass per view that draws each item once.
  void count(const PlanDraws& draws, VkExtent2D extent, Renderer::Counters& counters) const noexcept;
  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()) + (copy_ ? 3 : 2); }
  VkDeviceSize bytes() const noexcept { return tables_->bytes() + (copy_ ? canvas_->bytes() / 2 : 0); }
  VkDeviceSize imageBytes() const noexcept { return copy_ ? copy_->allocatedBytes() : 0; }

  /// Returns the parameters of a plan's tables. Not `measured` in frames without counting, and if the proxy's tiles do
  /// not fit into the canvas.
  static shader::ColourFrame frameOf(const FramePlan& plan, VkExtent2D extent, VkExtent2D canvas) noexcept;

 private:
  enum class Stage : std::uint8_t { proxy, count, redraw };
  struct Key {
    Stage stage;
    CellVariant variant;
    auto operator<=>(const Key&) const = default;
  };
  void draw(VkCommandBuffer commands, Stage stage, const DrawItem& item, BlendMode blend, std::uint32_t parameter,
            VkExtent2D extent) const noexcept;

  ColourTables* tables_;
  const CellPass* cells_;
  const Canvas* canvas_;
  PipelineLayoutHandle layout_, applyLayout_;
  std::map<Key, PipelineHandle> pipelines_;
  VkDescriptorSet proxySet_ = VK_NULL_HANDLE;
  // For the paper's sequence.
  std::optional<GpuImage> copy_;
  RenderPassHandle renderPass_;  // attaches only the canvas's colour, which is loaded
  FramebufferHandle framebuffer_;
  VkDescriptorSet sequenceSet_ = VK_NULL_HANDLE;
  PipelineHandle apply_;
};

}  // namespace ibr
