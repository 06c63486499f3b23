// SPDX-License-Identifier: Apache-2.0
#include "render/wireframe_pass.h"

#include <array>

#include "base/check.h"
#include "gpu/descriptors.h"
#include "gpu/pipeline.h"
#include "shaders/wireframe_frag.h"
#include "shared/cell.h"
#include "shared/wireframe.h"

namespace ibr {
namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

}  // namespace

WireframePass::WireframePass(const Device& device, const CellPass& cells, VkRenderPass renderPass,
                             const RendererOptions& options, const Requirements& requirements)
    : cells_(&cells) {
  const GpuScene::State& scene = cells.scene();
  const std::uint32_t most = device.properties().limits.maxStorageBufferRange;
  check(scene.vertices.size() <= most && scene.indices.size() <= most, ErrorCode::unsupported,
        "wireframe: the meshes take {} and {} bytes; {} can read {} in a shader", scene.vertices.size(),
        scene.indices.size(), device.name(), most);
  const std::array<VkDescriptorSetLayoutBinding, 2> bindings{
      {{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr},
       {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr}}};
  setLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  set_ = allocateSet(device, pool_.get(), setLayout_.get());
  writeStorageBuffer(device, set_, 0, scene.vertices.get());
  writeStorageBuffer(device, set_, 1, scene.indices.get());

  const std::array<VkDescriptorSetLayout, 3> sets{cells.frameLayout(), scene.sets.layout(), setLayout_.get()};
  const VkPushConstantRange constants{kStages, 0, sizeof(shader::WireframeConstants)};
  layout_ = makePipelineLayout(device, sets, {&constants, 1});
  const auto require = [&](const GpuScene::State::Mesh& mesh, bool mayDissolve) {
    for (const CellVariant& variant : variantsOf(mesh, mayDissolve, options.blends))
      for (const bool depth : {false, true})
        for (const bool mapped : {false, true}) {
          const Key key{variant, depth, mapped};
          if ((mapped && !requirements.colourTables) || pipelines_.contains(key)) continue;
          if (!(depth ? requirements.depthOrder : requirements.painters)) continue;
          pipelines_.emplace(key, makeCellPipeline(device, variant,
                                                   {.name = "wireframe",
                                                    .fragment = shaders::wireframe_frag,
                                                    .layout = layout_.get(),
                                                    .renderPass = renderPass,
                                                    .depth = depth,
                                                    .mapped = mapped,
                                                    .vertices = CellVertices::fetched}));
        }
  };
  for (const GpuScene::State::Mesh& cell : scene.cells) require(cell, requirements.dissolve);
  for (const GpuScene::State::Mesh& backdrop : scene.backdrops) require(backdrop, requirements.dissolve);
}

void WireframePass::draw(VkCommandBuffer commands, const FramePlan& plan, Order order, std::size_t view,
                         VkExtent2D extent) const noexcept {
  const auto ranks = float(order == Order::current ? plan.cells.size() : plan.former.size());
  cells_->bind(commands, layout_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetMeshes, 1, &set_, 0,
                          nullptr);
  cells_->eachStep(commands, plan, order, view, extent, [&](const Step& step, std::uint32_t parameter) {
    // Backdrops are coloured as though they came after all cells.
    const float rank = float(step.rank) + (step.tier == kTierBackdrop ? ranks : 0.0f);
    const shader::WireframeConstants constants{step.range.firstIndex, std::uint32_t(step.mesh->vertexOffset / 4), rank,
                                               ranks};
    const Key key{variantOf(step, plan.settings.blend), !cells_->isPainters(plan.settings),
                  cells_->isMapped(plan, step)};
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.at(key).get());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetCell, 1,
                            &step.mesh->photographs, 0, nullptr);
    vkCmdPushConstants(commands, layout_.get(), kStages, 0, sizeof constants, &constants);
    vkCmdDraw(commands, step.range.indexCount, 1, 0, parameter);
  });
}

}  // namespace ibr
