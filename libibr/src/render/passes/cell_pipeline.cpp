// SPDX-License-Identifier: Apache-2.0
#include "render/passes/cell_pipeline.h"

#include <algorithm>
#include <array>

#include "base/vulkan/pipeline.h"
#include "render/resident/gpu_scene_state.h"
#include "shaders/buffers_vert.h"
#include "shaders/cell_multiview_vert.h"
#include "shaders/cell_vert.h"
#include "shaders/overlay_vert.h"
#include "shared/cell.h"

namespace ibr {
namespace {

struct Constants {  // specialisation constants of the cell shaders
  std::int32_t members;
  VkBool32 singleArray;
  VkBool32 dissolve;
  std::uint32_t panoramas;
  std::uint32_t blending;
  VkBool32 mapped;
  std::uint32_t viewStride;
  VkBool32 cubic;
  std::uint32_t overlay;
  VkBool32 exposed;
  VkBool32 masked;
};

}  // namespace

CellVariant variantOf(const DrawItem& item, BlendMode blend) noexcept {
  return {.members = item.mesh->cameras.size(),
          .panoramas = item.mesh->panoramas,
          .cubic = item.mesh->cubic,
          .masked = item.mesh->masked,
          .singleArray = item.mesh->singleArray,
          .dissolve = item.opacity < 1.0f,
          .exposed = item.mesh->exposed,
          .blend = blend};
}

std::vector<CellVariant> variantsOf(const GpuScene::State::Mesh& mesh, bool mayDissolve,
                                    std::span<const BlendMode> blends) {
  std::vector<CellVariant> variants;
  for (const BlendMode blend : blends)
    for (const bool dissolve : {false, true})
      if (!dissolve || mayDissolve)
        variants.push_back({mesh.cameras.size(), mesh.panoramas, mesh.cubic, mesh.masked, mesh.singleArray, dissolve,
                            mesh.exposed, blend});
  return variants;
}

PipelineHandle makeCellPipeline(const Device& device, const CellVariant& variant, const CellPipelineInfo& wanted) {
  const auto members = std::uint32_t(variant.members);
  std::array<VkVertexInputAttributeDescription, shader::kMaxMembers + 2> attributes;
  for (std::uint32_t i = 0; i < shader::kMaxMembers; ++i)
    attributes[i] = {i, 0, VK_FORMAT_R32G32B32_SFLOAT, std::min(i, members - 1) * 12};
  attributes[shader::kMaxMembers] = {shader::kMaxMembers, 0, VK_FORMAT_R32_SFLOAT, members * 12};
  attributes[shader::kMaxMembers + 1] = {shader::kMaxMembers + 1, 1, VK_FORMAT_R32_SFLOAT, 0};
  const std::array<VkVertexInputBindingDescription, 2> bindings{
      {{0, vertexStride(members), VK_VERTEX_INPUT_RATE_VERTEX}, {1, sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX}}};
  constexpr std::array<VkSpecializationMapEntry, 11> kEntries{{{0, offsetof(Constants, members), 4},
                                                               {1, offsetof(Constants, singleArray), 4},
                                                               {2, offsetof(Constants, dissolve), 4},
                                                               {3, offsetof(Constants, panoramas), 4},
                                                               {4, offsetof(Constants, blending), 4},
                                                               {7, offsetof(Constants, mapped), 4},
                                                               {8, offsetof(Constants, viewStride), 4},
                                                               {9, offsetof(Constants, cubic), 4},
                                                               {10, offsetof(Constants, overlay), 4},
                                                               {11, offsetof(Constants, exposed), 4},
                                                               {12, offsetof(Constants, masked), 4}}};
  const Constants constants{std::int32_t(members),         variant.singleArray, variant.dissolve,  variant.panoramas,
                            std::uint32_t(variant.blend),  wanted.mapped,       wanted.viewStride, variant.cubic,
                            std::uint32_t(wanted.overlay), variant.exposed,     variant.masked};
  GraphicsPipelineInfo info;
  switch (wanted.vertices) {
    case CellVertices::attributes:
    case CellVertices::forBothEyes:
      info.vertex = wanted.vertices == CellVertices::attributes ? shaders::cell_vert : shaders::cell_multiview_vert;
      info.bindings = std::span(bindings).first(1);
      info.attributes = std::span(attributes).first(attributes.size() - 1);
      break;
    case CellVertices::withUncertainty:
      info.vertex = shaders::buffers_vert;
      info.bindings = bindings;
      info.attributes = attributes;
      break;
    case CellVertices::fetched:
      info.vertex = shaders::overlay_vert;
      break;
  }
  info.fragment = wanted.fragment;
  info.specialisation = {kEntries, std::as_bytes(std::span(&constants, 1))};
  info.layout = wanted.layout;
  info.renderPass = wanted.renderPass;
  info.colourFormats = wanted.colourFormats;
  info.depthFormat = wanted.depthFormat;
  info.depthTest = info.depthWrite = wanted.depth;
  info.depthClamp = true;  // surfaces nearer than nearDistance are drawn at that depth, not clipped
  if (wanted.overlay == Overlay::overlap) info.blending = Blending::add;
  info.name = wanted.name;
  return makeGraphicsPipeline(device, info);
}

}  // namespace ibr
