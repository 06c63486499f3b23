// SPDX-License-Identifier: Apache-2.0
// Minimal example: creates a device, loads a scene, plans a frame, records it and writes the image.
//
//   01_offscreen SCENE PICTURE.ppm
#include <ibr/ibr.h>

#include <cstdio>
#include <fstream>
#include <numbers>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 01_offscreen SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, {960, 540}));
  ibr::Offscreen offscreen(device, {960, 540});

  // Put the camera in the middle of the first cell, looking as its first photograph does.
  ibr::Camera view;
  view.intrinsics = ibr::pinholeFromFov(960, 540, std::numbers::pi / 4);
  const ibr::Cell& cell = scene.cells.at(0);
  for (const std::uint32_t member : cell.members)
    view.pose.position += scene.nodes[member].camera.pose.position / double(cell.members.size());
  view.pose.rotation = scene.nodes[cell.members[0]].camera.pose.rotation;

  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  const ibr::Image8 picture =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });

  std::ofstream file(argv[2], std::ios::binary);
  file << "P6\n" << picture.width << ' ' << picture.height << "\n255\n";
  for (std::size_t i = 0; i < picture.values.size(); i += 4)
    file.write(reinterpret_cast<const char*>(&picture.values[i]), 3);
  if (!file.flush()) throw ibr::Error(ibr::ErrorCode::io, std::string(argv[2]) + ": cannot be written");
  std::printf("%s: %zu cells drawn on %s\n", argv[2], plan.cells.size(), device.name().c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "01_offscreen: %s\n", error.what());
  return 2;
}
