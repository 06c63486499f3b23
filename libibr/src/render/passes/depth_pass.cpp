// SPDX-License-Identifier: Apache-2.0
#include "render/passes/depth_pass.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "gpu/draw/descriptors.h"
#include "render/passes/cell_pass.h"
#include "shaders/composite_vert.h"
#include "shaders/depth_frag.h"

namespace ibr {
namespace {

constexpr std::array kFormats{VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM};

std::size_t indexOf(VkFormat format) {
  return std::size_t(std::find(kFormats.begin(), kFormats.end(), format) - kFormats.begin());
}

struct Constants {
  float slots, stepDepth, nearDistance, offset, slope, scaleX, scaleY;
};

}  // namespace

bool DepthPass::supports(VkFormat format) noexcept {
  return indexOf(format) < kFormats.size();
}

DepthPass::DepthPass(const Device& device, const Canvas& canvas, const Canvas* eyes, bool hidden) {
  const VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler_ = make<SamplerHandle>(device, vkCreateSampler, nearest, "vkCreateSampler");
  std::array<VkDescriptorSetLayoutBinding, 2> bindings{};  // depth and colour
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  setLayout_ = makeSetLayout(device, bindings);
  const std::vector<CanvasSource> sources = sourcesOf(canvas, eyes);
  const auto count = std::uint32_t(sources.size());
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count * std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, count, {&size, 1});
  for (const CanvasSource& source : sources) {
    sets_.push_back(allocateSet(device, pool_.get(), setLayout_.get()));
    writeSampledImage(device, sets_.back(), 0, sampler_.get(), source.depth);
    writeSampledImage(device, sets_.back(), 1, sampler_.get(), source.colour);
  }
  const VkDescriptorSetLayout setLayout = setLayout_.get();
  const VkPushConstantRange constants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(Constants)};
  layout_ = makePipelineLayout(device, {&setLayout, 1}, {&constants, 1});
  const VkBool32 variant = hidden;
  const VkSpecializationMapEntry entry{0, 0, sizeof variant};
  for (const VkFormat format : kFormats)
    pipelines_.push_back(
        makeGraphicsPipeline(device, {.name = "depth",
                                      .vertex = shaders::composite_vert,
                                      .fragment = shaders::depth_frag,
                                      .specialisation = {{&entry, 1}, std::as_bytes(std::span(&variant, 1))},
                                      .layout = layout_.get(),
                                      .depthFormat = format}));
}

void DepthPass::record(VkCommandBuffer commands, std::size_t source, std::uint32_t items, double nearDistance,
                       VkExtent2D drawn, VkExtent2D extent, const DepthTarget& target) const noexcept {
  assert(supports(target.format));
  transitionTarget(commands, target, target.initialUse, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  const VkRenderingAttachmentInfo attachment =
      depthAttachment(target.view, VK_ATTACHMENT_LOAD_OP_DONT_CARE, VK_ATTACHMENT_STORE_OP_STORE);
  beginRendering(commands, extent, {}, &attachment);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_[indexOf(target.format)].get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &sets_[source], 0, nullptr);
  // depth = offset + slope / z maps near → 0 and far → 1; an infinite far plane is the limit.
  const double n = target.nearPlane, f = target.farPlane;
  double offset = std::isinf(f) ? 1.0 : f / (f - n);
  double slope = -n * offset;
  if (target.reversed) {
    offset = 1.0 - offset;
    slope = -slope;
  }
  const Constants constants{float(items + 1),
                            kStepDepth,
                            float(nearDistance),
                            float(offset),
                            float(slope),
                            float(drawn.width) / float(extent.width),
                            float(drawn.height) / float(extent.height)};
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof constants, &constants);
  vkCmdDraw(commands, 3, 1, 0, 0);
  vkCmdEndRendering(commands);
  transitionTarget(commands, target, use::kDepthAttachment, target.finalUse, VK_IMAGE_ASPECT_DEPTH_BIT);
}

}  // namespace ibr
