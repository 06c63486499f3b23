// SPDX-License-Identifier: Apache-2.0
// Pipelines that draw cells: one vertex stage, a fragment stage for each purpose, specialised by properties of a mesh.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "render/passes/draw_list.h"

namespace ibr {

/// Properties of a draw item that specialise its shaders.
struct CellVariant {
  std::size_t members;
  std::uint32_t panoramas;  // bit i: member i is a panorama
  bool cubic;               // TextureFilter::bicubic
  bool masked;              // a member's photograph has a mask
  bool singleArray;         // all members' photographs are layers of one image: dithering takes one sample
  bool dissolve;            // opacity below 1
  bool exposed;             // a photograph of the scene has a gain other than 1
  BlendMode blend;
  auto operator<=>(const CellVariant&) const = default;
};

CellVariant variantOf(const DrawItem& item, BlendMode blend) noexcept;

/// Returns the variants in which a mesh may be drawn: each declared blend mode, without and, if `mayDissolve`, with
/// dissolving.
std::vector<CellVariant> variantsOf(const GpuScene::State::Mesh& mesh, bool mayDissolve,
                                    std::span<const BlendMode> blends);

/// Input of the vertex stage.
enum class CellVertices : std::uint8_t {
  attributes,       // q_i and ρ: cell.vert
  forBothEyes,      // the same: cell_multiview.vert
  withUncertainty,  // also the uncertainty of ρ, from a second buffer: buffers.vert
  fetched,          // none: overlay.vert reads storage buffers
};

struct CellPipelineInfo {
  const char* name = "";
  std::span<const std::uint32_t> fragment;  // includes shaders/render/cell_colour.glsl
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass renderPass = VK_NULL_HANDLE;
  bool depth = false;   // test and write
  bool mapped = false;  // kMapped of cell_mapped.glsl
  CellVertices vertices = CellVertices::attributes;
  std::span<const VkFormat> colourFormats;  // for dynamic rendering if there is no renderPass, with
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;
  std::uint32_t viewStride = 0;  // for both eyes: distance from an item's parameters in one view to the next view's
  Overlay overlay = Overlay::none;
};

PipelineHandle makeCellPipeline(const Device& device, const CellVariant& variant, const CellPipelineInfo& info);

}  // namespace ibr
