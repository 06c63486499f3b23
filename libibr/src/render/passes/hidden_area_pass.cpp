// SPDX-License-Identifier: Apache-2.0
#include "render/passes/hidden_area_pass.h"

#include <cmath>
#include <span>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "shaders/hidden_area_frag.h"
#include "shaders/hidden_area_multiview_vert.h"
#include "shaders/hidden_area_vert.h"
#include "shared/hidden_area.h"

namespace ibr {
namespace {

constexpr float kMaxTangent = 1e6f;  // tangent: larger values exceed the precision of float

// Maps tangents to normalised device coordinates, for any size of the image.
glm::vec4 toClip(const Intrinsics& k) {
  return {2.0 * k.fx / k.width, 2.0 * k.cx / k.width - 1.0, -2.0 * k.fy / k.height, 2.0 * k.cy / k.height - 1.0};
}

}  // namespace

void checkHiddenArea(const std::array<std::vector<glm::vec2>, 2>& triangles) {
  for (std::size_t view = 0; view < triangles.size(); ++view) {
    check(triangles[view].size() % 3 == 0, ErrorCode::invalidInput,
          "renderer: hiddenArea[{}] has {} corners, not a multiple of three", view, triangles[view].size());
    for (std::size_t i = 0; i < triangles[view].size(); ++i) {
      const glm::vec2 corner = triangles[view][i];
      check(std::abs(corner.x) <= kMaxTangent && std::abs(corner.y) <= kMaxTangent, ErrorCode::invalidInput,
            "renderer: hiddenArea[{}][{}] is ({}, {}), coordinates are limited to ±{}", view, i, corner.x, corner.y,
            kMaxTangent);
    }
  }
}

HiddenArea::HiddenArea(const Device& device, const std::array<std::vector<glm::vec2>, 2>& triangles,
                       VkRenderPass renderPass, VkRenderPass eyesPass, Uploader& uploader) {
  std::vector<glm::vec3> corners;
  for (std::size_t view = 0; view < triangles.size(); ++view) {
    counts_[view] = std::uint32_t(triangles[view].size());
    for (const glm::vec2 corner : triangles[view]) corners.emplace_back(corner, float(view));
  }
  corners_ =
      Buffer(device, corners.size() * sizeof corners[0],
             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device, "hidden area");
  uploader.buffer(corners_, 0, std::as_bytes(std::span(corners)));

  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(shader::HiddenAreaConstants)};
  layout_ = makePipelineLayout(device, {}, {&constants, 1});
  const VkVertexInputBindingDescription binding{0, sizeof(glm::vec3), VK_VERTEX_INPUT_RATE_VERTEX};
  const VkVertexInputAttributeDescription attribute{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
  const auto pipeline = [&](VkRenderPass pass, std::span<const std::uint32_t> vertex) {
    return makeGraphicsPipeline(device, {.name = "hidden area",
                                         .vertex = vertex,
                                         .fragment = shaders::hidden_area_frag,
                                         .bindings = {&binding, 1},
                                         .attributes = {&attribute, 1},
                                         .layout = layout_.get(),
                                         .renderPass = pass,
                                         .depthTest = true,
                                         .depthWrite = true});
  };
  single_ = pipeline(renderPass, shaders::hidden_area_vert);
  if (eyesPass) eyes_ = pipeline(eyesPass, shaders::hidden_area_multiview_vert);
}

void HiddenArea::draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view,
                      VkExtent2D extent) const noexcept {
  record(commands, single_.get(), plan, extent, view == 0 ? 0 : counts_[0], counts_[view]);
}

void HiddenArea::drawEyes(VkCommandBuffer commands, const FramePlan& plan, VkExtent2D extent) const noexcept {
  record(commands, eyes_.get(), plan, extent, 0, counts_[0] + counts_[1]);
}

void HiddenArea::record(VkCommandBuffer commands, VkPipeline pipeline, const FramePlan& plan, VkExtent2D extent,
                        std::uint32_t first, std::uint32_t count) const noexcept {
  if (count == 0) return;
  setViewport(commands, extent);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  shader::HiddenAreaConstants constants{};
  for (std::size_t view = 0; view < plan.views.size(); ++view)
    constants.toClip[view] = toClip(plan.views[view].intrinsics);
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, &constants);
  const VkBuffer corners = corners_.get();
  const VkDeviceSize offset = 0;
  vkCmdBindVertexBuffers(commands, 0, 1, &corners, &offset);
  vkCmdDraw(commands, count, 1, first, 0);
}

}  // namespace ibr
