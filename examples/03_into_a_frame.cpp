// SPDX-License-Identifier: Apache-2.0
// Records into the middle of an engine's frame: sky, then the photographed place, then water that the place hides.
//
//   03_into_a_frame SCENE PICTURE.ppm
//
// Renderer::record replaces its target, so the place gets an image of its own, whose alpha is 0 in holes, and the
// engine puts it over the sky. What follows is tested against the place's depth, which record writes into the engine's
// depth image in the engine's convention.
#include <ibr/ibr.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "shaders/over_frag.h"
#include "shaders/screen_vert.h"
#include "shaders/sky_frag.h"
#include "shaders/water_frag.h"
#include "shaders/water_vert.h"
#include "vulkan_helpers.h"

namespace {

constexpr VkExtent2D kSize{960, 540};
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM, kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr double kNear = 0.1;       // near plane of the engine, world units
constexpr float kWaterHeight = -4;  // above the camera, world units: chosen for the bundled cathedral

// The engine's images and pipelines.
struct Engine {
  helpers::Image frame, place, depth;
  helpers::Textures placeTexture;
  helpers::Pipeline sky, over, water;
  helpers::Buffer pixels;

  explicit Engine(const helpers::Gpu& gpu)
      : frame(gpu, kFormat, kSize, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT),
        place(gpu, kFormat, kSize, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT),
        depth(gpu, kDepthFormat, kSize, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT),
        placeTexture(gpu, {&place}),
        sky(gpu, {.vertex = screen_vert, .fragment = sky_frag, .colour = kFormat, .constantBytes = sizeof(glm::vec2)}),
        over(gpu, {.vertex = screen_vert,
                   .fragment = over_frag,
                   .colour = kFormat,
                   .depth = kDepthFormat,
                   .textures = &placeTexture}),
        water(gpu, {.vertex = water_vert,
                    .fragment = water_frag,
                    .colour = kFormat,
                    .depth = kDepthFormat,
                    .blends = true,
                    .constantBytes = sizeof(glm::mat4) + sizeof(float)}),
        pixels(gpu, 4 * kSize.width * kSize.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT) {}
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 03_into_a_frame SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::GpuScene gpuScene(device, scene);
  ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  settings.maxTier = ibr::kTierCompleted;    // holes are not filled …
  settings.alpha = ibr::AlphaContent::tier;  // … and have an alpha of 0
  ibr::RendererOptions options = ibr::optionsFor(settings, kSize);
  options.depth = true;
  const ibr::Renderer renderer(device, gpuScene, options);

  ibr::Camera view = scene.nodes.at(0).camera;
  view.pose.position = (view.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});

  const helpers::Gpu gpu{device.physicalDevice(), device.handle(), device.queue(), device.queueFamily()};
  const Engine engine(gpu);
  const ibr::DepthTarget depth{
      .image = engine.depth.handle, .view = engine.depth.views[0], .format = kDepthFormat, .nearPlane = kNear};
  const ibr::Target place{.image = engine.place.handle,
                          .view = engine.place.views[0],
                          .format = kFormat,
                          .extent = kSize,
                          .finalUse = ibr::use::kSampled,
                          .depth = depth};
  const glm::vec2 tangents(kSize.width / (2 * view.intrinsics.fx), kSize.height / (2 * view.intrinsics.fy));
  const struct {
    glm::mat4 toClip;
    float height;
  } waterConstants{glm::mat4(ibr::clipFromCamera(view.intrinsics, kNear)), kWaterHeight};

  helpers::submitAndWait(gpu, [&](VkCommandBuffer commands) {
    helpers::barrier(commands, engine.frame, ibr::use::kUndefined, ibr::use::kColourAttachment);
    helpers::beginRendering(commands, engine.frame, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
    engine.sky.draw(commands, 3, &tangents);
    vkCmdEndRendering(commands);

    renderer.record(commands, plan, place);

    helpers::barrier(commands, engine.frame, ibr::use::kColourAttachment, ibr::use::kColourAttachment);
    helpers::beginRendering(commands, engine.frame, VK_ATTACHMENT_LOAD_OP_LOAD, &engine.depth);
    engine.over.draw(commands, 3);
    engine.water.draw(commands, 6, &waterConstants);
    vkCmdEndRendering(commands);
    helpers::barrier(commands, engine.frame, ibr::use::kColourAttachment, ibr::use::kTransferSource);
    helpers::copyToBuffer(commands, engine.frame, engine.pixels);
  });
  helpers::writePpm(argv[2], engine.pixels.data, kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "03_into_a_frame: %s\n", error.what());
  return 2;
}
