// SPDX-License-Identifier: Apache-2.0
#include "vr/show/shapes_pass.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <span>

#include "base/vulkan/barrier.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "shaders/shapes_frag.h"
#include "shaders/shapes_vert.h"

namespace ibr::app {
namespace {

constexpr float kOccludedOpacity = 0.3f;  // opacity of occluded shapes

struct Constants {
  glm::mat4 toClip;
  float strength;
};
constexpr std::uint32_t kConstantBytes = sizeof(glm::mat4) + sizeof(float);

}  // namespace

ShapesPass::ShapesPass(const Device& device, VkFormat colour, VkFormat depth, std::uint32_t slots)
    : device_(device), slots_(slots) {
  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, kConstantBytes};
  layout_ = makePipelineLayout(device, {}, {&constants, 1});
  constexpr VkVertexInputBindingDescription kBinding{0, sizeof(ShapeVertex), VK_VERTEX_INPUT_RATE_VERTEX};
  constexpr std::array<VkVertexInputAttributeDescription, 2> kAttributes{
      {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(ShapeVertex, position)},
       {1, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(ShapeVertex, colour)}}};
  const VkBool32 linear = isSrgb(colour);
  constexpr VkSpecializationMapEntry kLinear{0, 0, sizeof(VkBool32)};
  GraphicsPipelineInfo info{.name = "shapes",
                            .vertex = shaders::shapes_vert,
                            .fragment = shaders::shapes_frag,
                            .specialisation = {{&kLinear, 1}, std::as_bytes(std::span(&linear, 1))},
                            .bindings = {&kBinding, 1},
                            .attributes = kAttributes,
                            .layout = layout_.get(),
                            .colourFormats = {&colour, 1},
                            .depthFormat = depth,
                            .blending = Blending::over};
  untested_ = makeGraphicsPipeline(device, info);
  info.depthTest = info.depthWrite = true;  // runtimes reproject by depth, so shapes must write it
  tested_ = makeGraphicsPipeline(device, info);
}

void ShapesPass::setShapes(std::uint32_t slot, const Shapes& shapes) {
  Slot& s = slots_[slot];
  s.inSpace = std::uint32_t(shapes.inSpace.size());
  s.onView = std::uint32_t(shapes.onView.size());
  const VkDeviceSize bytes = (shapes.inSpace.size() + shapes.onView.size()) * sizeof(ShapeVertex);
  if (bytes == 0) return;
  if (s.vertices.size() < bytes)
    s.vertices = Buffer(device_, std::max<VkDeviceSize>(2 * bytes, 1 << 16), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
                        MemoryKind::upload, "shapes");
  const auto first = std::as_bytes(std::span(shapes.inSpace)), rest = std::as_bytes(std::span(shapes.onView));
  std::ranges::copy(first, s.vertices.mapped().begin());
  std::ranges::copy(rest, s.vertices.mapped().begin() + std::ptrdiff_t(first.size()));
}

void ShapesPass::record(VkCommandBuffer commands, std::uint32_t slot, const Camera& eye, const Target& target,
                        double nearPlane, double farPlane) const noexcept {
  const Slot& s = slots_[slot];
  if (s.inSpace + s.onView == 0) return;
  // The image was drawn just before: waits for its writes.
  transitionTarget(commands, target, use::kColourAttachment, use::kColourAttachment);
  transitionTarget(commands, *target.depth, use::kDepthAttachment, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  const VkRenderingAttachmentInfo colour = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_LOAD);
  const VkRenderingAttachmentInfo depth =
      depthAttachment(target.depth->view, VK_ATTACHMENT_LOAD_OP_LOAD, VK_ATTACHMENT_STORE_OP_STORE);
  beginRendering(commands, target.extent, {&colour, 1}, &depth);
  const VkBuffer buffer = s.vertices.get();
  const VkDeviceSize start = 0;
  vkCmdBindVertexBuffers(commands, 0, 1, &buffer, &start);
  const glm::dmat4 lens = clipFromCamera(eye.intrinsics, nearPlane, farPlane);
  const auto draw = [&](const PipelineHandle& pipeline, const glm::dmat4& toClip, float strength, std::uint32_t first,
                        std::uint32_t count) {
    if (count == 0) return;
    const Constants constants{glm::mat4(toClip), strength};
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
    vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, kConstantBytes, &constants);
    vkCmdDraw(commands, count, 1, first, 0);
  };
  const glm::dmat4 space = lens * cameraFromWorld(eye.pose);
  draw(untested_, space, kOccludedOpacity, 0, s.inSpace);
  draw(tested_, space, 1, 0, s.inSpace);
  draw(untested_, lens, 1, s.inSpace, s.onView);
  vkCmdEndRendering(commands);
}

}  // namespace ibr::app
