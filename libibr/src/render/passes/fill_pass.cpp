// SPDX-License-Identifier: Apache-2.0
#include "render/passes/fill_pass.h"

#include <array>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "shaders/fill_pull_comp.h"
#include "shaders/fill_push_comp.h"
#include "shared/fill.h"

namespace ibr {
namespace {

struct Constants {
  std::int32_t fine[2], coarse[2];
};

struct Levels {
  std::array<VkExtent2D, 33> extents;  // of the canvas, then of the levels in use
  std::uint32_t count = 0;             // number of levels
};

Levels levelsIn(VkExtent2D extent) noexcept {
  Levels levels;
  levels.extents[0] = extent;
  do {
    extent = levels.extents[++levels.count] = FillPass::coarser(extent);
  } while (extent.width > 1 || extent.height > 1);
  return levels;
}

// Layout and access of a level that the next dispatch reads.
constexpr ImageUse kComputeSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

}  // namespace

FillPass::FillPass(const Device& device, VkExtent2D largest, std::span<const VkImageView> sources) {
  VkExtent2D extent = largest;
  do {
    extent = coarser(extent);
    levels_.emplace_back(device,
                         GpuImageInfo{.format = VK_FORMAT_R16G16B16A16_SFLOAT,
                                      .extent = extent,
                                      .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT},
                         "fill level");
  } while (extent.width > 1 || extent.height > 1);

  const VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler_ = make<SamplerHandle>(device, vkCreateSampler, nearest, "vkCreateSampler");
  const std::array<VkDescriptorSetLayoutBinding, 2> bindings{{
      {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
      {1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
  }};
  setLayout_ = makeSetLayout(device, bindings);
  const auto sets = std::uint32_t(sources.size() + 2 * (levels_.size() - 1));
  const std::array<VkDescriptorPoolSize, 2> sizes{
      {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets}, {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, sets}}};
  pool_ = makeDescriptorPool(device, sets, sizes);
  const auto makeSet = [&](VkImageView from, const GpuImage& to) {
    const VkDescriptorSet set = allocateSet(device, pool_.get(), setLayout_.get());
    writeSampledImage(device, set, 0, sampler_.get(), from);
    writeStorageImage(device, set, 1, to.view());
    return set;
  };
  for (const VkImageView source : sources) pullFirst_.push_back(makeSet(source, levels_[0]));
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    pull_.push_back(makeSet(levels_[l].view(), levels_[l + 1]));
    push_.push_back(makeSet(levels_[l + 1].view(), levels_[l]));
  }

  const VkDescriptorSetLayout setLayout = setLayout_.get();
  const VkPushConstantRange constants{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(Constants)};
  layout_ = makePipelineLayout(device, {&setLayout, 1}, {&constants, 1});
  const auto pipeline = [&](const char* name, std::span<const std::uint32_t> shader, VkBool32 fromCanvas) {
    const VkSpecializationMapEntry entry{0, 0, sizeof fromCanvas};
    return makeComputePipeline(device, {.name = name,
                                        .shader = shader,
                                        .specialisation = {{&entry, 1}, std::as_bytes(std::span(&fromCanvas, 1))},
                                        .layout = layout_.get()});
  };
  pullCanvas_ = pipeline("fill: pull from the canvas", shaders::fill_pull_comp, VK_TRUE);
  pullLevel_ = pipeline("fill: pull", shaders::fill_pull_comp, VK_FALSE);
  pushLevel_ = pipeline("fill: push", shaders::fill_push_comp, VK_FALSE);
}

VkDeviceSize FillPass::allocatedBytes() const noexcept {
  VkDeviceSize bytes = 0;
  for (const GpuImage& level : levels_) bytes += level.allocatedBytes();
  return bytes;
}

VkDeviceSize FillPass::bytes() const noexcept {
  VkDeviceSize bytes = 0;
  for (const GpuImage& level : levels_)
    bytes += VkDeviceSize(8) * level.info().extent.width * level.info().extent.height;
  return bytes;
}

void FillPass::dispatch(VkCommandBuffer commands, VkPipeline pipeline, VkDescriptorSet set, VkExtent2D fine,
                        VkExtent2D coarse, VkExtent2D threads) const noexcept {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  const Constants constants{{std::int32_t(fine.width), std::int32_t(fine.height)},
                            {std::int32_t(coarse.width), std::int32_t(coarse.height)}};
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
  const auto groups = [](std::uint32_t n) { return (n + shader::kFillGroup - 1) / shader::kFillGroup; };
  vkCmdDispatch(commands, groups(threads.width), groups(threads.height), 1);
}

std::uint32_t FillPass::dispatchCount(VkExtent2D extent) noexcept {
  return 2 * levelsIn(extent).count - 1;
}

void FillPass::record(VkCommandBuffer commands, VkExtent2D extent, std::size_t source) const noexcept {
  const auto [extents, used] = levelsIn(extent);

  // Contents are discarded; passes of the previous frame may still read them.
  constexpr ImageUse kReadInitial{VK_IMAGE_LAYOUT_UNDEFINED,
                                  VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
  bufferBarrier(commands, {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
                {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT});
  for (std::size_t l = 0; l < used; ++l) {
    transition(commands, levels_[l].get(), kReadInitial, use::kStorage);
    dispatch(commands, l == 0 ? pullCanvas_.get() : pullLevel_.get(), l == 0 ? pullFirst_[source] : pull_[l - 1],
             extents[l], extents[l + 1], extents[l + 1]);
    transition(commands, levels_[l].get(), use::kStorage, kComputeSampled);
  }
  for (std::size_t l = used - 1; l-- > 0;) {
    transition(commands, levels_[l].get(), kComputeSampled, use::kStorage);
    dispatch(commands, pushLevel_.get(), push_[l], extents[l + 1], extents[l + 2], extents[l + 1]);
    transition(commands, levels_[l].get(), use::kStorage, kComputeSampled);
  }
  transition(commands, levels_[0].get(), kComputeSampled, use::kSampled);
}

}  // namespace ibr
