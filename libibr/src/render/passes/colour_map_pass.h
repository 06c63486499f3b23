// SPDX-License-Identifier: Apache-2.0
// The frame's colour mapping ([T] §2.5.3), our way and the paper's.
//
// Ours: before the canvas is drawn, all cells' tier 0 go side by side into it as tiles of a small picture, the proxy,
// at the picture's detail; a compute pass counts raw colours by owner, one workgroup makes all tables; the cell pass
// applies them. The canvas is big enough for the tiles, so the proxy needs no memory.
//
// Paper: front to back, cell by cell: copy of the framebuffer, a fragment stage that counts or writes, a table, and its
// application by compute over all pixels or by redraw. Same meshes, textures, filters and culling as ours. Tiers 1 and
// 2 follow, unseen by the histograms, through their cells' tables. Only the first view is counted; a second one is
// drawn with its tables ([T] §2.5.4).
#pragma once

#include <map>
#include <optional>

#include "gpu/device/handle.h"
#include "gpu/draw/canvas.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/renderer.h"
#include "render/passes/cell_pass.h"
#include "render/passes/colour_tables.h"

namespace ibr {

class ColourMapPass {
 public:
  /// What the canvas's colour image must be usable for.
  static constexpr VkImageUsageFlags canvasUse(ColourSupport support) {
    return support == ColourSupport::all ? VK_IMAGE_USAGE_STORAGE_BIT : 0;
  }

  /// All must outlive it. The options' colour support is not off.
  ColourMapPass(Device& device, ColourTables& tables, const CellPass& cells, const Canvas& canvas,
                const RendererOptions& options);

  /// Ours: makes the frame's tables; cells' parameters have been updated. Leaves the canvas ended, its contents of no
  /// use. Outside a render pass. `extent`: of the canvas's picture. For the first view, unless eyes have tables of
  /// their own.
  void makeTables(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent) const noexcept;

  /// The paper's sequence: makes the tables and draws the first view, from Canvas::begin to what Canvas::end promises.
  void drawSequence(VkCommandBuffer commands, const FramePlan& plan, VkExtent2D extent) const noexcept;

  /// Adds what these passes do beyond drawing each step once in one pass a view.
  void count(const FramePlan& plan, VkExtent2D extent, Renderer::Counters& counters) const noexcept;
  std::uint32_t pipelineCount() const noexcept { return std::uint32_t(pipelines_.size()) + (copy_ ? 3 : 2); }
  VkDeviceSize bytes() const noexcept { return tables_->bytes() + (copy_ ? canvas_->bytes() / 2 : 0); }
  VkDeviceSize imageBytes() const noexcept { return copy_ ? copy_->allocatedBytes() : 0; }

  /// What a plan's tables are made for. Not `measured` in frames that do not count, and where the proxy's tiles would
  /// not fit into the canvas.
  static shader::ColourFrame frameOf(const FramePlan& plan, VkExtent2D extent, VkExtent2D canvas) noexcept;

 private:
  enum class Stage : std::uint8_t { proxy, count, redraw };
  struct Key {
    Stage stage;
    CellVariant variant;
    auto operator<=>(const Key&) const = default;
  };
  void draw(VkCommandBuffer commands, Stage stage, const Step& step, BlendMode blend, std::uint32_t parameter,
            VkExtent2D extent) const noexcept;

  ColourTables* tables_;
  const CellPass* cells_;
  const Canvas* canvas_;
  PipelineLayoutHandle layout_, applyLayout_;
  std::map<Key, PipelineHandle> pipelines_;
  VkDescriptorSet proxySet_ = VK_NULL_HANDLE;
  // Of the paper's sequence.
  std::optional<GpuImage> copy_;
  RenderPassHandle renderPass_;  // on the canvas's colour alone, keeping it
  FramebufferHandle framebuffer_;
  VkDescriptorSet sequenceSet_ = VK_NULL_HANDLE;
  PipelineHandle apply_;
};

}  // namespace ibr
