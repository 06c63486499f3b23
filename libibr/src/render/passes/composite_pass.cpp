// SPDX-License-Identifier: Apache-2.0
#include "render/passes/composite_pass.h"

#include <array>
#include <cassert>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "base/vulkan/target_format.h"
#include "gpu/draw/descriptors.h"
#include "render/passes/canvas_source.h"
#include "render/passes/floor_plane.h"
#include "shaders/composite_frag.h"
#include "shaders/composite_vert.h"
#include "shared/overlay.h"

namespace ibr {
namespace {

struct Constants {
  glm::vec3 background;
  std::uint32_t keepTier;
  glm::vec2 fillExtent, canvasExtent, targetExtent;
  float previousWeight;
  shader::FloorConstants floor;
};
static_assert(sizeof(Constants) == 96);

struct Variant {  // specialisation constants
  VkBool32 linear, previous, fill, scaled, floor, hidden;
};

glm::vec2 vectorOf(VkExtent2D extent) {
  return {float(extent.width), float(extent.height)};
}

}  // namespace

CompositePass::CompositePass(Device& device, const Canvas& canvas, const Canvas* eyes, const Canvas* previous,
                             const FillPass* fill, const RendererOptions& options, bool hidden) {
  const VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler_ = make<SamplerHandle>(device, vkCreateSampler, nearest, "vkCreateSampler");
  VkSamplerCreateInfo linear = nearest;
  linear.magFilter = linear.minFilter = VK_FILTER_LINEAR;
  linear.addressModeU = linear.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  linear_ = make<SamplerHandle>(device, vkCreateSampler, linear, "vkCreateSampler");
  std::array<VkDescriptorSetLayoutBinding, 3> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  setLayout_ = makeSetLayout(device, bindings);
  const std::vector<CanvasSource> sources = sourcesOf(canvas, eyes);
  const auto count = std::uint32_t(sources.size());
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count * std::uint32_t(bindings.size())};
  pool_ = makeDescriptorPool(device, count, {&size, 1});
  for (const CanvasSource& source : sources) {
    const VkDescriptorSet set = sets_.emplace_back(allocateSet(device, pool_.get(), setLayout_.get()));
    writeSampledImage(device, set, 0, sampler_.get(), source.colour);
    // A binding must be valid even if the shader does not read it.
    writeSampledImage(device, set, 1, sampler_.get(), previous ? previous->colourView() : source.colour);
    writeSampledImage(device, set, 2, linear_.get(), fill ? fill->colours().view() : source.colour);
  }

  const VkDescriptorSetLayout setLayout = setLayout_.get();
  const VkPushConstantRange constants{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(Constants)};
  layout_ = makePipelineLayout(device, {&setLayout, 1}, {&constants, 1});
  const auto require = [&](const Key& key) {
    checkTargetFormat("renderer", key.format);
    constexpr std::array<VkSpecializationMapEntry, 6> kEntries{{{0, offsetof(Variant, linear), 4},
                                                                {1, offsetof(Variant, previous), 4},
                                                                {2, offsetof(Variant, fill), 4},
                                                                {3, offsetof(Variant, scaled), 4},
                                                                {4, offsetof(Variant, floor), 4},
                                                                {5, offsetof(Variant, hidden), 4}}};
    const Variant variant{takesLinear(key.format), key.previous, key.filled, key.scaled, key.floor, hidden};
    GraphicsPipelineInfo info;
    info.vertex = shaders::composite_vert;
    info.fragment = shaders::composite_frag;
    info.specialisation = {kEntries, std::as_bytes(std::span(&variant, 1))};
    info.layout = layout_.get();
    info.colourFormats = {&key.format.format, 1};
    info.name = "composite";
    pipelines_.emplace(key, makeGraphicsPipeline(device, info));
  };
  for (const TargetFormat& format : options.formats)
    for (const bool mixed : {false, true})
      for (const bool filled : {false, true})
        for (const bool scaled : {false, true})
          for (const bool floor : {false, true})
            if ((!mixed || previous) && (!filled || fill) && (!scaled || options.maxRenderScale > 0) &&
                (!floor || options.floor))
              require({format, mixed, filled, scaled, floor});
}

void CompositePass::record(VkCommandBuffer commandBuffer, std::size_t source, const FramePlan& plan, std::size_t view,
                           VkExtent2D drawn, float previousWeight, bool filled, const Target& target) const noexcept {
  const RenderSettings& settings = plan.settings;
  const bool scaled = drawn.width != target.extent.width || drawn.height != target.extent.height;
  const Key key{formatOf(target), previousWeight > 0, filled, scaled, settings.floor.has_value()};
  assert(pipelines_.contains(key));
  transitionTarget(commandBuffer, target, target.initialUse, use::kColourAttachment);
  const VkRenderingAttachmentInfo attachment = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
  beginRendering(commandBuffer, target.extent, {&attachment, 1});
  vkCmdBindPipeline(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.at(key).get());
  vkCmdBindDescriptorSets(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &sets_[source], 0,
                          nullptr);
  const bool showsHoles = settings.overlay == Overlay::tiers;
  const Constants constants{showsHoles ? shader::tierColour(std::uint32_t(kTierFilled)) : settings.background,
                            settings.alpha == AlphaContent::tier,
                            vectorOf(FillPass::coarser(drawn)),
                            vectorOf(drawn),
                            vectorOf(target.extent),
                            previousWeight,
                            floorConstants(plan, view)};
  vkCmdPushConstants(commandBuffer, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof constants, &constants);
  vkCmdDraw(commandBuffer, 3, 1, 0, 0);
  vkCmdEndRendering(commandBuffer);
  transitionTarget(commandBuffer, target, use::kColourAttachment, target.finalUse);
}

}  // namespace ibr
