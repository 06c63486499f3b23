// SPDX-License-Identifier: Apache-2.0
// A pass of the caller between passes of libibr: fog by the depth of the photographed place, under the lines of the
// image graph.
//
//   09_custom_pass SCENE PICTURE.ppm
#include <ibr/ibr.h>

#include <cstdio>
#include <numbers>

#include "shaders/fog_frag.h"
#include "shaders/screen_vert.h"
#include "vulkan_helpers.h"

namespace {

constexpr VkExtent2D kSize{960, 540};

ibr::BufferTarget bufferTarget(const helpers::Image& image, const ibr::ImageUse& finalUse) {
  return {.image = image.handle, .view = image.views[0], .finalUse = finalUse};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 09_custom_pass SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::GpuScene gpuScene(device, scene);
  ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  settings.maxTier = ibr::kTierCompleted;  // filled pixels have no depth; fog covers the holes
  ibr::RendererOptions options = ibr::optionsFor(settings, kSize);
  options.bufferScene = &scene;  // for recordBuffers
  const ibr::Renderer renderer(device, gpuScene, options);
  const ibr::GraphOverlay overlay(device, ibr::imageGraph(scene), {.frustumDepth = 0.3});

  ibr::Camera view = scene.nodes.at(0).camera;
  view.pose.position = (view.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  std::vector<std::uint32_t> best;  // cells by rank
  for (const ibr::PlannedCell& cell : plan.cells) best.push_back(cell.cell);

  const helpers::Gpu gpu{device.physicalDevice(), device.handle(), device.queue(), device.queueFamily()};
  const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  const VkImageUsageFlags drawn = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, sampled = VK_IMAGE_USAGE_SAMPLED_BIT;
  const helpers::Image colour(gpu, format, kSize, drawn | sampled),
      surface(gpu, ibr::kSurfaceFormat, kSize, drawn | sampled), weights(gpu, ibr::kWeightsFormat, kSize, drawn),
      confidence(gpu, ibr::kConfidenceFormat, kSize, drawn),
      frame(gpu, format, kSize, drawn | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  const helpers::Buffer pixels(gpu, 4 * kSize.width * kSize.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  const struct {
    glm::vec4 colour{0.8f, 0.82f, 0.85f, 1};
    float range = 30;  // world units
  } fogConstants;
  const helpers::Textures rendered(gpu, {&colour, &surface});
  const helpers::Pipeline fog(gpu, {.vertex = screen_vert,
                                    .fragment = fog_frag,
                                    .colour = format,
                                    .constantBytes = sizeof(glm::vec4) + sizeof(float),
                                    .textures = &rendered});

  // Each target says which use its image has after the pass, so the next pass needs no barrier of its own.
  const ibr::Target place{.image = colour.handle,
                          .view = colour.views[0],
                          .format = format,
                          .extent = kSize,
                          .finalUse = ibr::use::kSampled};
  const ibr::BufferTargets buffers{.extent = kSize,
                                   .surface = bufferTarget(surface, ibr::use::kSampled),
                                   .weights = bufferTarget(weights, ibr::use::kColourAttachment),
                                   .confidence = bufferTarget(confidence, ibr::use::kColourAttachment)};
  const ibr::Target foggy{.image = frame.handle,
                          .view = frame.views[0],
                          .format = format,
                          .extent = kSize,
                          .initialUse = ibr::use::kColourAttachment,
                          .finalUse = ibr::use::kTransferSource};
  helpers::submitAndWait(gpu, [&](VkCommandBuffer commands) {
    renderer.record(commands, plan, place);
    renderer.recordBuffers(commands, plan, 0, buffers);

    helpers::barrier(commands, frame, ibr::use::kUndefined, ibr::use::kColourAttachment);
    helpers::beginRendering(commands, frame, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
    fog.draw(commands, 3, &fogConstants);
    vkCmdEndRendering(commands);

    overlay.record(commands, view, best, foggy);
    helpers::copyToBuffer(commands, frame, pixels);
  });
  helpers::writePpm(argv[2], pixels.data, kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "09_custom_pass: %s\n", error.what());
  return 2;
}
