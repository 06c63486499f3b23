// SPDX-License-Identifier: Apache-2.0
#include "render/passes/colour_tables.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "image/blue_noise.h"
#include "shaders/colour_count_comp.h"
#include "shaders/colour_tables_comp.h"
#include "shared/cell.h"

namespace ibr {
namespace {

static_assert(shader::kMaxMappedCells == int(kMaxCellCount));

constexpr std::uint32_t kMaxSetCount = 4;

// Stages and accesses of all passes that use these buffers.
constexpr BufferUse kAnyPass{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                             VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};

struct SlotRange {
  std::uint32_t first, last;
};

Buffer storage(const Device& device, VkDeviceSize bytes, const char* name) {
  constexpr VkBufferUsageFlags kUsage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  return Buffer(device, bytes, kUsage, MemoryKind::device, name);
}

}  // namespace

ColourTables::ColourTables(Device& device, std::uint32_t cells, Uploader& uploader)
    : cells_(cells),
      frame_(storage(device, sizeof(shader::ColourFrame), "colour frame")),
      counters_(storage(device, 4 * std::max(shader::counterCount(cells, true), shader::counterCount(cells, false)),
                        "colour histograms")),
      slots_(storage(device, kColourSlotCount * sizeof(shader::ColourSlot), "colour slots")),
      tables_(storage(device, (kColourSlotCount + 1) * shader::kLevels * 4, "colour tables")),
      noise_(storage(device, 4 * shader::kNoiseSize * shader::kNoiseSize, "colour noise")) {
  assert(cells >= 1 && cells <= std::uint32_t(shader::kMaxMappedCells));
  const std::vector<shader::ColourSlot> nobody(kColourSlotCount);
  uploader.buffer(slots_, 0, std::as_bytes(std::span(nobody)));
  std::vector<std::uint32_t> identity;
  for (std::uint32_t level = 0; level < std::uint32_t(shader::kLevels); ++level)
    identity.push_back(shader::packLevels(level, level, level));
  uploader.buffer(tables_, kColourSlotCount * shader::kLevels * 4, std::as_bytes(std::span(identity)));
  const std::vector<std::uint16_t> ranks = blueNoise(shader::kNoiseSize, 1);
  const std::vector<std::uint32_t> noise(ranks.begin(), ranks.end());
  uploader.buffer(noise_, 0, std::as_bytes(std::span(noise)));

  const VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler_ = make<SamplerHandle>(device, vkCreateSampler, nearest, "vkCreateSampler");
  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  std::array<VkDescriptorSetLayoutBinding, 7> bindings{};
  for (std::uint32_t b = 0; b < bindings.size(); ++b)
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr};
  bindings[shader::kBindingPicture].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  bindings[shader::kBindingCanvas].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  setLayout_ = makeSetLayout(device, bindings);
  const std::array<VkDescriptorPoolSize, 3> sizes{{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 5 * kMaxSetCount},
                                                   {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kMaxSetCount},
                                                   {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, kMaxSetCount}}};
  pool_ = makeDescriptorPool(device, kMaxSetCount, sizes);

  const VkDescriptorSetLayout set = setLayout_.get();
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(SlotRange)};
  layout_ = makePipelineLayout(device, {&set, 1}, {&range, 1});
  count_ = makeComputePipeline(device,
                               {.name = "colour count", .shader = shaders::colour_count_comp, .layout = layout_.get()});
  chain_ = makeComputePipeline(
      device, {.name = "colour tables", .shader = shaders::colour_tables_comp, .layout = layout_.get()});
}

VkDescriptorSet ColourTables::makeSet(const Device& device, VkImageView picture, VkImageView canvas) {
  const VkDescriptorSet set = allocateSet(device, pool_.get(), setLayout_.get());
  const std::array<const Buffer*, 5> buffers{&frame_, &counters_, &slots_, &tables_, &noise_};
  for (std::uint32_t b = 0; b < buffers.size(); ++b) writeStorageBuffer(device, set, b, buffers[b]->get());
  writeSampledImage(device, set, shader::kBindingPicture, sampler_.get(), picture);
  if (canvas != VK_NULL_HANDLE) {
    const VkDescriptorImageInfo info{VK_NULL_HANDLE, canvas, VK_IMAGE_LAYOUT_GENERAL};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .dstBinding = shader::kBindingCanvas,
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                     .pImageInfo = &info};
    vkUpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
  }
  return set;
}

void ColourTables::begin(VkCommandBuffer commands, const shader::ColourFrame& frame) const noexcept {
  assert(frame.count <= cells_);
  bufferBarrier(commands, kAnyPass, use::kTransferWrite);
  vkCmdUpdateBuffer(commands, frame_.get(), 0, sizeof frame, &frame);
  if (const VkDeviceSize bytes = 4 * shader::counterCount(frame.count, frame.joint != 0); frame.measured && bytes > 0)
    vkCmdFillBuffer(commands, counters_.get(), 0, bytes, 0);
  bufferBarrier(commands, use::kTransferWrite, kAnyPass);
}

void ColourTables::count(VkCommandBuffer commands, VkDescriptorSet set,
                         const shader::ColourFrame& frame) const noexcept {
  // Upper bound of a counter, and of the sums of a cell's counters: they must not overflow 32 bits.
  assert(std::uint64_t(frame.tileWidth) * frame.tileHeight < std::uint64_t(1) << 32);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, count_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  vkCmdDispatch(commands, (frame.tileWidth + 7) / 8, (frame.tileHeight + 7) / 8, 1);
}

void ColourTables::chain(VkCommandBuffer commands, VkDescriptorSet set, std::uint32_t first,
                         std::uint32_t last) const noexcept {
  bufferBarrier(commands, kAnyPass, use::kComputeReadWrite);
  const SlotRange range{first, last};
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, chain_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof range, &range);
  vkCmdDispatch(commands, 1, 1, 1);
  bufferBarrier(commands, use::kComputeReadWrite, kAnyPass);
}

}  // namespace ibr
