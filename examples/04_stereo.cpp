// SPDX-License-Identifier: Apache-2.0
// Two views in one plan, into the two layers of an image, as a headset's compositor takes them. The views share the
// draw order and the colours, so nothing differs between the eyes but parallax.
//
//   04_stereo SCENE PICTURE.ppm      writes both views side by side
#include <ibr/ibr.h>

#include <array>
#include <cstdio>
#include <numbers>

#include "vulkan_helpers.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 04_stereo SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  constexpr VkExtent2D kSize{960, 540};   // of an eye
  constexpr double kEyeDistance = 0.065;  // world units: metres, if the poses are metric
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  ibr::RendererOptions options = ibr::optionsFor(settings, kSize);
  options.maxViews = 2;
  const ibr::Renderer renderer(device, gpuScene, options);

  // The left eye has the view of 01_offscreen. A headset has its own tangents for each eye: ibr::pinholeFromTangents.
  ibr::Camera left = scene.nodes.at(0).camera;
  left.pose.position = (left.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  left.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);
  ibr::Camera right = left;
  right.pose.position += right.pose.rotation * glm::dvec3(kEyeDistance, 0, 0);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{left, right}, settings});

  const helpers::Gpu gpu{device.physicalDevice(), device.handle(), device.queue(), device.queueFamily()};
  const helpers::Image eyes(gpu, VK_FORMAT_R8G8B8A8_UNORM, kSize,
                            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, 2);
  const helpers::Buffer pixels(gpu, 2 * 4 * kSize.width * kSize.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  std::array<ibr::Target, 2> targets;
  for (std::uint32_t eye = 0; eye < 2; ++eye)
    targets[eye] = {.image = eyes.handle,
                    .view = eyes.views[eye],
                    .format = eyes.format,
                    .extent = eyes.extent,
                    .finalUse = ibr::use::kTransferSource,
                    .layer = eye};
  helpers::submitAndWait(gpu, [&](VkCommandBuffer commands) {
    renderer.record(commands, plan, targets);
    helpers::copyToBuffer(commands, eyes, pixels);
  });
  helpers::writePpm(argv[2], pixels.data, 2 * kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "04_stereo: %s\n", error.what());
  return 2;
}
