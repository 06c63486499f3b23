// SPDX-License-Identifier: Apache-2.0
#include "htm/draw_pass.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "base/check.h"
#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "htm/coordinates_pass.h"
#include "shaders/htm_colours_frag.h"
#include "shaders/htm_colours_vert.h"
#include "shaders/htm_depth_vert.h"
#include "shaders/htm_frag.h"
#include "shaders/htm_vert.h"

namespace ibr {
namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
// Frames share the image: the next one waits for the last one's tests, its contents are lost.
constexpr ImageUse kDepthBefore{VK_IMAGE_LAYOUT_UNDEFINED, use::kDepthAttachment.stages, use::kDepthAttachment.access};

bool isSrgb(VkFormat format) {
  return format == VK_FORMAT_R8G8B8A8_SRGB || format == VK_FORMAT_B8G8R8A8_SRGB;
}

bool isSupported(VkFormat format) {
  return isSrgb(format) || format == VK_FORMAT_R8G8B8A8_UNORM || format == VK_FORMAT_B8G8R8A8_UNORM;
}

float decoded(float value) {  // IEC 61966-2-1
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

PipelineHandle makeShading(const Device& device, VkPipelineLayout layout, VkFormat format, bool displaced,
                           bool colours) {
  struct Variant {
    VkBool32 srgb, displaced;
  };
  constexpr VkSpecializationMapEntry kEntries[]{{0, offsetof(Variant, srgb), 4}, {1, offsetof(Variant, displaced), 4}};
  const Variant variant{isSrgb(format), displaced};
  return makeGraphicsPipeline(device, {.name = colours ? "vertex colours" : "harmonised textures",
                                       .vertex = colours ? shaders::htm_colours_vert : shaders::htm_vert,
                                       .fragment = colours ? shaders::htm_colours_frag : shaders::htm_frag,
                                       .specialisation = {kEntries, std::as_bytes(std::span(&variant, 1))},
                                       .layout = layout,
                                       .colourFormats = {&format, 1},
                                       .depthFormat = kDepthFormat,
                                       .depthTest = true,
                                       .depthEqual = true});
}

}  // namespace

HtmDrawPass::HtmDrawPass(const Device& device, const HtmFrameSet& set, const HtmRendererOptions& options)
    : depth_(device,
             {.format = kDepthFormat,
              .extent = options.largest,
              .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
              .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
             "depth of a harmonised model's picture"),
      depthPipeline_(makeGraphicsPipeline(device, {.name = "depth of a harmonised model",
                                                   .vertex = shaders::htm_depth_vert,
                                                   .layout = set.layout(),
                                                   .depthFormat = kDepthFormat,
                                                   .depthTest = true})) {
  for (const VkFormat format : options.formats) {
    check(isSupported(format), ErrorCode::unsupported, "harmonised renderer: VkFormat {} is not 8-bit RGBA or BGRA",
          int(format));
    Format& made = formats_.emplace_back();
    made.format = format;
    made.pipelines[kDisplaced] = makeShading(device, set.layout(), format, true, false);
    made.pipelines[kPlain] = makeShading(device, set.layout(), format, false, false);
    made.pipelines[kColours] = makeShading(device, set.layout(), format, false, true);
  }
}

void HtmDrawPass::record(VkCommandBuffer commands, const HtmFrameSet& set, const HtmFramePlan& plan,
                         const Target& target) const noexcept {
  const auto found = std::ranges::find(formats_, target.format, &Format::format);
  assert(found != formats_.end() && !target.depth);
  transition(commands, depth_.get(), kDepthBefore, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  transition(commands, target.image, target.before, use::kColourAttachment);

  VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  depth.imageView = depth_.view();
  depth.imageLayout = use::kDepthAttachment.layout;
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  depth.clearValue.depthStencil = {1.0f, 0};
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea = {{0, 0}, target.extent};
  rendering.layerCount = 1;
  rendering.pDepthAttachment = &depth;
  const VkViewport viewport{0, 0, float(target.extent.width), float(target.extent.height), 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
  const bool draws = set.model().triangleCount > 0 && !plan.cameras.empty();
  const std::uint32_t corners = 3 * set.model().triangleCount;
  if (draws) set.bind(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, set.frame(plan));

  vkCmdBeginRendering(commands, &rendering);
  if (draws) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, depthPipeline_.get());
    vkCmdDraw(commands, corners, 1, 0, 0);
  }
  vkCmdEndRendering(commands);
  transition(commands, depth_.get(), use::kDepthAttachment, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);

  depth.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  colour.imageView = target.view;
  colour.imageLayout = use::kColourAttachment.layout;
  colour.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  const glm::vec3 background = plan.settings.background;
  for (int c = 0; c < 3; ++c)
    colour.clearValue.color.float32[c] = isSrgb(target.format) ? decoded(background[c]) : background[c];
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &colour;
  vkCmdBeginRendering(commands, &rendering);
  if (draws) {
    const Shading shading = plan.settings.method == HtmMethod::vertexColours ? kColours
                            : htmDisplaces(set.model(), plan)                ? kDisplaced
                                                                             : kPlain;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, found->pipelines[shading].get());
    vkCmdDraw(commands, corners, 1, 0, 0);
  }
  vkCmdEndRendering(commands);
  transition(commands, target.image, use::kColourAttachment, target.after);
}

}  // namespace ibr
