// SPDX-License-Identifier: Apache-2.0
#include "render/cell_pass.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "gpu/barrier.h"
#include "gpu/descriptors.h"
#include "gpu/pipeline.h"
#include "gpu/upload.h"
#include "image/blue_noise.h"
#include "render/cell_parameters.h"
#include "render/gpu_scene.h"
#include "shaders/cell_frag.h"
#include "shaders/cell_vert.h"
#include "shared/cell.h"

namespace ibr {
namespace {

constexpr std::uint32_t kLargestStepCount = 2 * kLargestCellCount;  // a step is one tier of one cell

struct Step {
  const PlannedCell* planned;
  Tier tier;
};

struct Steps {
  std::array<Step, kLargestStepCount> step;
  std::uint32_t count = 0;
};

// Best first.
Steps stepsOf(const FramePlan& plan) noexcept {
  Steps steps;
  for (int tier = kTierAgrees; tier <= std::min<int>(plan.settings.lowestTier, kTierRejected); ++tier)
    for (const PlannedCell& planned : plan.cells) steps.step[steps.count++] = {&planned, Tier(tier)};
  return steps;
}

PipelineHandle makePipeline(const Device& device, VkPipelineLayout layout, VkRenderPass renderPass,
                            std::int32_t members, bool depth) {
  std::array<VkVertexInputAttributeDescription, shader::kMaxMembers + 1> attributes;
  for (std::uint32_t i = 0; i < shader::kMaxMembers; ++i)
    attributes[i] = {i, 0, VK_FORMAT_R32G32B32_SFLOAT, std::min(i, std::uint32_t(members) - 1) * 12};
  attributes[shader::kMaxMembers] = {shader::kMaxMembers, 0, VK_FORMAT_R32_SFLOAT, std::uint32_t(members) * 12};
  const VkVertexInputBindingDescription binding{0, vertexStride(std::size_t(members)), VK_VERTEX_INPUT_RATE_VERTEX};
  const VkSpecializationMapEntry entry{0, 0, sizeof members};
  GraphicsPipelineInfo info;
  info.vertex = shaders::cell_vert;
  info.fragment = shaders::cell_frag;
  info.specialisation = {{&entry, 1}, std::as_bytes(std::span(&members, 1))};
  info.bindings = {&binding, 1};
  info.attributes = attributes;
  info.layout = layout;
  info.renderPass = renderPass;
  info.depthTest = info.depthWrite = depth;
  info.depthClamp = true;  // what is nearer than nearDistance is drawn at that depth, not cut
  info.name = "cells";
  return makeGraphicsPipeline(device, info);
}

}  // namespace

CellPass::CellPass(Device& device, const GpuScene& scene, VkRenderPass renderPass) : scene_(&scene.state()) {
  const std::vector<std::uint16_t> ranks = blueNoise(shader::kNoiseSize, 1);
  const std::vector<std::uint32_t> noise(ranks.begin(), ranks.end());
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  parameters_ =
      Buffer(device, kLargestStepCount * sizeof(shader::CellParameters), kUsage, MemoryKind::device, "cell parameters");
  noise_ = Buffer(device, noise.size() * sizeof(std::uint32_t), kUsage, MemoryKind::device, "blue noise");
  uploadBuffer(device, noise_, 0, std::as_bytes(std::span(noise)));

  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  const std::array<VkDescriptorSetLayoutBinding, 2> bindings{{
      {shader::kBindingParameters, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr},
      {shader::kBindingNoise, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
  }};
  frameLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, 1, {&size, 1});
  frameSet_ = allocateSet(device, pool_.get(), frameLayout_.get());
  writeStorageBuffer(device, frameSet_, shader::kBindingParameters, parameters_.get());
  writeStorageBuffer(device, frameSet_, shader::kBindingNoise, noise_.get());

  const std::array<VkDescriptorSetLayout, 2> layouts{frameLayout_.get(), scene_->photographLayout.get()};
  layout_ = makePipelineLayout(device, layouts, {});
  // Only for the member counts that the scene has.
  for (const GpuScene::State::GpuCell& cell : scene_->cells)
    for (bool depth : {false, true})
      if (PipelineHandle& pipeline = pipeline_[cell.cameras.size() - 2][depth]; !pipeline.get())
        pipeline = makePipeline(device, layout_.get(), renderPass, std::int32_t(cell.cameras.size()), depth);
}

void CellPass::update(VkCommandBuffer commandBuffer, const FramePlan& plan) const noexcept {
  const Steps steps = stepsOf(plan);
  if (steps.count == 0) return;
  // The data travels inside the command buffer, so any number of frames may be recorded ahead, or never be submitted.
  bufferBarrier(commandBuffer, use::kShaderRead, use::kTransferWrite);
  constexpr std::uint32_t kAtOnce = 65536 / sizeof(shader::CellParameters);
  std::array<shader::CellParameters, kAtOnce> chunk;
  for (std::uint32_t first = 0; first < steps.count; first += kAtOnce) {
    const std::uint32_t count = std::min(kAtOnce, steps.count - first);
    for (std::uint32_t s = 0; s < count; ++s) {
      const Step& step = steps.step[first + s];
      const GpuScene::State::GpuCell& cell = scene_->cells[step.planned->cell];
      chunk[s] = cellParameters(plan, *step.planned, cell.cameras, cell.layers, step.tier);
    }
    vkCmdUpdateBuffer(commandBuffer, parameters_.get(), first * sizeof chunk[0], count * sizeof chunk[0], chunk.data());
  }
  bufferBarrier(commandBuffer, use::kTransferWrite, use::kShaderRead);
}

void CellPass::draw(VkCommandBuffer commandBuffer, const FramePlan& plan, VkExtent2D extent) const noexcept {
  const Steps steps = stepsOf(plan);
  if (steps.count == 0) return;
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetScissor(commandBuffer, 0, 1, &scissor);
  vkCmdBindIndexBuffer(commandBuffer, scene_->indices.get(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdBindDescriptorSets(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetFrame, 1,
                          &frameSet_, 0, nullptr);
  const bool paper = plan.settings.order == DrawOrder::paper;
  for (std::uint32_t k = 0; k < steps.count; ++k) {
    const std::uint32_t s = paper ? steps.count - 1 - k : k;
    const GpuScene::State::GpuCell& cell = scene_->cells[steps.step[s].planned->cell];
    const GpuScene::State::Range& range = cell.tier[steps.step[s].tier];
    if (range.indexCount == 0) continue;
    const float slots = float(steps.count + 1);
    const VkViewport viewport{0, 0, float(extent.width), float(extent.height), float(s) / slots, float(s + 1) / slots};
    vkCmdSetViewport(commandBuffer, 0, 1, &viewport);
    vkCmdBindPipeline(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_[cell.cameras.size() - 2][!paper].get());
    vkCmdBindDescriptorSets(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), shader::kSetCell, 1,
                            &cell.photographs, 0, nullptr);
    const VkBuffer vertices = scene_->vertices.get();
    vkCmdBindVertexBuffers(commandBuffer, 0, 1, &vertices, &cell.vertexOffset);
    vkCmdDrawIndexed(commandBuffer, range.indexCount, 1, range.firstIndex, 0, s);  // the step is the instance
  }
}

}  // namespace ibr
