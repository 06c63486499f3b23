// SPDX-License-Identifier: Apache-2.0
#include "test_picture.h"

#include <span>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "gpu/draw/descriptors.h"
#include "ibr/offscreen.h"
#include "shaders/test_coloured_frag.h"
#include "shaders/test_coloured_vert.h"
#include "shaders/test_copy_frag.h"
#include "shaders/test_screen_vert.h"
#include "support/upload_buffer.h"

namespace ibr::test {
namespace {

PipelineHandle drawPipeline(const Device& device, VkPipelineLayout layout, VkRenderPass renderPass,
                            const PicturePasses::Settings& settings) {
  constexpr VkVertexInputBindingDescription kBindings[]{{0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX}};
  constexpr VkVertexInputAttributeDescription kAttributes[]{
      {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
      {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, colour)}};
  constexpr VkSpecializationMapEntry kEntries[]{{0, 0, sizeof(float)}};
  return makeGraphicsPipeline(device, {.name = "test draw",
                                       .vertex = shaders::test_coloured_vert,
                                       .fragment = shaders::test_coloured_frag,
                                       .specialisation = {kEntries, std::as_bytes(std::span(&settings.brightness, 1))},
                                       .bindings = kBindings,
                                       .attributes = kAttributes,
                                       .layout = layout,
                                       .renderPass = renderPass,
                                       .depthTest = settings.depth,
                                       .depthWrite = settings.depth,
                                       .depthClamp = true});
}

}  // namespace

std::vector<Vertex> square(float low, float high, float z, glm::vec3 colour) {
  const Vertex a{{low, -1, z}, colour}, b{{high, -1, z}, colour}, c{{high, 1, z}, colour}, d{{low, 1, z}, colour};
  return {a, b, c, a, c, d};
}

PicturePasses::PicturePasses(const Device& device, VkExtent2D largest, const std::vector<Vertex>& vertices,
                             const Settings& settings)
    : count_(std::uint32_t(vertices.size())),
      canvas_(device, largest),
      vertices_(device, vertices.size() * sizeof(Vertex),
                VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device,
                "test vertices"),
      drawLayout_(makePipelineLayout(device, {}, {})),
      draw_(drawPipeline(device, drawLayout_.get(), canvas_.renderPass(), settings)) {
  uploadBuffer(device, vertices_, 0, std::as_bytes(std::span(vertices)));

  const VkDescriptorSetLayoutBinding bindings[]{
      {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr}};
  setLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize sizes[]{{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1}};
  pool_ = makeDescriptorPool(device, 1, sizes);
  const VkSamplerCreateInfo samplerInfo{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler_ = make<SamplerHandle>(device, vkCreateSampler, samplerInfo, "vkCreateSampler");
  set_ = allocateSet(device, pool_.get(), setLayout_.get());
  writeSampledImage(device, set_, 0, sampler_.get(), canvas_.colourView());
  const VkDescriptorSetLayout layouts[]{setLayout_.get()};
  compositionLayout_ = makePipelineLayout(device, layouts, {});
  composition_ = makeGraphicsPipeline(device, {.name = "test composition",
                                               .vertex = shaders::test_screen_vert,
                                               .fragment = shaders::test_copy_frag,
                                               .layout = compositionLayout_.get(),
                                               .colourFormats = {&settings.target, 1}});
}

void PicturePasses::recordCanvas(VkCommandBuffer commands, VkExtent2D extent) const noexcept {
  canvas_.begin(commands, extent, {0.2f, 0.4f, 0.6f, 0.8f});
  setViewport(commands, extent);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, draw_.get());
  const VkBuffer buffer = vertices_.get();
  const VkDeviceSize offset = 0;
  vkCmdBindVertexBuffers(commands, 0, 1, &buffer, &offset);
  vkCmdDraw(commands, count_, 1, 0, 0);
  canvas_.end(commands);
}

void PicturePasses::recordComposition(VkCommandBuffer commands, const Target& target) const noexcept {
  transition(commands, target.image, target.initialUse, use::kColourAttachment);
  const VkRenderingAttachmentInfo attachment = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
  beginRendering(commands, target.extent, {&attachment, 1});
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, composition_.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, compositionLayout_.get(), 0, 1, &set_, 0, nullptr);
  vkCmdDraw(commands, 3, 1, 0, 0);
  vkCmdEndRendering(commands);
  transition(commands, target.image, use::kColourAttachment, target.finalUse);
}

Image8 samplePicture(const Device& device) {
  std::vector<Vertex> vertices = square(-1.0f, 0.0f, 0.25f, {1, 0, 0});
  for (const Vertex& vertex : square(-0.5f, 0.5f, 0.5f, {0, 1, 0})) vertices.push_back(vertex);
  const VkExtent2D extent{16, 8};
  const PicturePasses passes(device, extent, vertices, {});
  Offscreen offscreen(device, extent);
  return offscreen.render([&](VkCommandBuffer commands) {
    passes.recordCanvas(commands, extent);
    passes.recordComposition(commands, offscreen.target());
  });
}

Image8 expectedPicture() {
  Image8 picture(16, 8, 4);
  const auto colourAt = [](int x) -> std::array<std::uint8_t, 4> {
    if (x < 8) return {255, 0, 0, 255};
    if (x < 12) return {0, 255, 0, 255};
    return {51, 102, 153, 204};
  };
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      const auto colour = colourAt(x);
      std::copy(colour.begin(), colour.end(), picture.pixel(x, y).begin());
    }
  return picture;
}

}  // namespace ibr::test
