// SPDX-License-Identifier: Apache-2.0
// The shortest way to a picture: creates a device, loads a scene, plans a frame, records it and writes the image.
//
//   01_offscreen SCENE PICTURE.ppm
#include <ibr/ibr.h>

#include <cstdio>
#include <numbers>

#include "vulkan_helpers.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 01_offscreen SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  constexpr VkExtent2D kSize{960, 540};
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, kSize));
  ibr::Offscreen offscreen(device, kSize);

  // The camera stands halfway between the first two photographs, and looks as the first one does.
  ibr::Camera view = scene.nodes.at(0).camera;
  view.pose.position = (view.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);

  // A plan is plain data. An application makes one for each frame, and passes the previous plan's `next` along.
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  const ibr::Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
    if (gpuScene.needsStreaming()) gpuScene.stream(commands, plan, 1, 0);  // large scenes load over several frames
    renderer.record(commands, plan, offscreen.target());
  });

  helpers::writePpm(argv[2], picture.values.data(), kSize.width, kSize.height);
  std::printf("%s: %zu cells and %zu photographs drawn on %s\n", argv[2], plan.cells.size(), plan.photographs.size(),
              device.name().c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "01_offscreen: %s\n", error.what());
  return 2;
}
