// SPDX-License-Identifier: Apache-2.0
#include "htm/draw_pass.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "base/vulkan/target_format.h"
#include "htm/coordinates_pass.h"
#include "shaders/htm_colours_frag.h"
#include "shaders/htm_colours_vert.h"
#include "shaders/htm_depth_vert.h"
#include "shaders/htm_frag.h"
#include "shaders/htm_vert.h"

namespace ibr {
namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
// Frames share the image: a frame waits for the depth tests of the previous one and discards the contents.
constexpr ImageUse kDepthInitial{VK_IMAGE_LAYOUT_UNDEFINED, use::kDepthAttachment.stages, use::kDepthAttachment.access};

PipelineHandle makeShading(const Device& device, VkPipelineLayout layout, TargetFormat format, bool displaced,
                           bool colours) {
  struct Variant {
    VkBool32 linear, displaced;
  };
  constexpr VkSpecializationMapEntry kEntries[]{{0, offsetof(Variant, linear), 4},
                                                {1, offsetof(Variant, displaced), 4}};
  const Variant variant{takesLinear(format), displaced};
  return makeGraphicsPipeline(device, {.name = colours ? "vertex colours" : "harmonised textures",
                                       .vertex = colours ? shaders::htm_colours_vert : shaders::htm_vert,
                                       .fragment = colours ? shaders::htm_colours_frag : shaders::htm_frag,
                                       .specialisation = {kEntries, std::as_bytes(std::span(&variant, 1))},
                                       .layout = layout,
                                       .colourFormats = {&format.format, 1},
                                       .depthFormat = kDepthFormat,
                                       .depthTest = true,
                                       .depthEqual = true});
}

}  // namespace

HtmDrawPass::HtmDrawPass(const Device& device, const HtmFrameSet& set, const HtmRendererOptions& options)
    : depth_(device,
             {.format = kDepthFormat,
              .extent = options.maxExtent,
              .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
              .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
             "depth of a harmonised model's image"),
      depthPipeline_(makeGraphicsPipeline(device, {.name = "depth of a harmonised model",
                                                   .vertex = shaders::htm_depth_vert,
                                                   .layout = set.layout(),
                                                   .depthFormat = kDepthFormat,
                                                   .depthTest = true})) {
  for (const TargetFormat& format : options.formats) {
    checkTargetFormat("harmonised renderer", format);
    Format& made = formats_.emplace_back(Format{.format = format});
    made.pipelines[kDisplaced] = makeShading(device, set.layout(), format, true, false);
    made.pipelines[kPlain] = makeShading(device, set.layout(), format, false, false);
    made.pipelines[kColours] = makeShading(device, set.layout(), format, false, true);
  }
}

void HtmDrawPass::record(VkCommandBuffer commands, const HtmFrameSet& set, const HtmFramePlan& plan,
                         const Target& target) const noexcept {
  const auto found = std::ranges::find(formats_, formatOf(target), &Format::format);
  assert(found != formats_.end() && !target.depth);
  transition(commands, depth_.get(), kDepthInitial, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  transitionTarget(commands, target, target.initialUse, use::kColourAttachment);

  const bool draws = set.model().triangleCount > 0 && !plan.cameras.empty();
  const std::uint32_t corners = 3 * set.model().triangleCount;
  // Pushes the constants for each pipeline: after a pipeline without a fragment stage, lavapipe of Mesa 25.0 does not
  // pass them to the next fragment stage.
  const auto bindFrame = [&] { set.bind(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, set.frame(plan)); };
  const VkRenderingAttachmentInfo written =
      depthAttachment(depth_.view(), VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_STORE);
  beginRendering(commands, target.extent, {}, &written);
  if (draws) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, depthPipeline_.get());
    bindFrame();
    vkCmdDraw(commands, corners, 1, 0, 0);
  }
  vkCmdEndRendering(commands);
  transition(commands, depth_.get(), use::kDepthAttachment, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);

  const glm::vec3 background = writtenColour(plan.settings.background, formatOf(target));
  const VkRenderingAttachmentInfo colour =
      colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, {{background.r, background.g, background.b, 0.0f}});
  const VkRenderingAttachmentInfo tested =
      depthAttachment(depth_.view(), VK_ATTACHMENT_LOAD_OP_LOAD, VK_ATTACHMENT_STORE_OP_DONT_CARE);
  beginRendering(commands, target.extent, {&colour, 1}, &tested);
  if (draws) {
    const Shading shading = plan.settings.method == HtmMethod::vertexColours ? kColours
                            : htmDisplaces(set.model(), plan)                ? kDisplaced
                                                                             : kPlain;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, found->pipelines[shading].get());
    bindFrame();
    vkCmdDraw(commands, corners, 1, 0, 0);
  }
  vkCmdEndRendering(commands);
  transitionTarget(commands, target, use::kColourAttachment, target.finalUse);
}

}  // namespace ibr
