// SPDX-License-Identifier: Apache-2.0
// Pipelines that draw cells' meshes: one vertex stage, a fragment stage for each purpose, variants by what a mesh is.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gpu/device/handle.h"
#include "ibr/device.h"
#include "render/passes/steps.h"

namespace ibr {

/// What specialisation makes of the shaders of a step.
struct CellVariant {
  std::size_t members;
  std::uint32_t panoramas;  // bit i: member i is one
  bool cubic;               // TextureFilter::bicubic
  bool masked;              // a member's photograph has a mask
  bool onePage;             // all members' photographs are layers of one image: dithering takes one sample
  bool dissolve;            // opacity below 1
  bool exposed;             // a photograph of the scene has a gain other than 1
  BlendMode blend;
  auto operator<=>(const CellVariant&) const = default;
};

CellVariant variantOf(const Step& step, BlendMode blend) noexcept;

/// Variants in which a mesh may be drawn: with and without dissolving, in every way of blending that is declared. With
/// one member there is nothing to blend.
std::vector<CellVariant> variantsOf(const GpuScene::State::Mesh& mesh, bool mayDissolve,
                                    std::span<const BlendMode> blends);

/// What the vertex stage reads.
enum class CellVertices : std::uint8_t {
  attributes,       // q_i and ρ: cell.vert
  forBothEyes,      // the same: cell_multiview.vert
  withUncertainty,  // and that of ρ, in a second buffer: buffers.vert
  fetched,          // nothing: overlay.vert fetches for itself
};

struct CellPipelineInfo {
  const char* name = "";
  std::span<const std::uint32_t> fragment;  // begins with shaders/render/cell_colour.glsl
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass renderPass = VK_NULL_HANDLE;
  bool depth = false;   // test and write
  bool mapped = false;  // kMapped of cell_mapped.glsl
  CellVertices vertices = CellVertices::attributes;
  std::span<const VkFormat> colourFormats;  // without a render pass: of dynamic rendering, with
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;
  std::uint32_t viewStride = 0;  // for both eyes: from a step's parameters for one view to those for the next
  Overlay overlay = Overlay::none;
};

PipelineHandle makeCellPipeline(const Device& device, const CellVariant& variant, const CellPipelineInfo& info);

}  // namespace ibr
