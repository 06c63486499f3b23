// SPDX-License-Identifier: Apache-2.0
// Builds a draft of a scene and renders the view of its first photograph.
//
//   consumer PHOTOGRAPHS MODEL SCENE PICTURE.ppm
#include <ibr/author/build.h>
#include <ibr/ibr.h>

#include <cstdio>
#include <fstream>

int main(int argc, char** argv) try {
  if (argc != 5) return 1;
  ibr::BuildOptions options;
  options.photographs = argv[1];
  options.model = argv[2];
  options.output = argv[3];
  options.maxSize = 320;
  options.draft = true;
  ibr::build(options);

  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[3]);
  const ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, {320, 240}));
  ibr::Offscreen offscreen(device, {320, 240});
  ibr::Camera view = scene.nodes.at(0).camera;
  view.intrinsics = ibr::pinholeFromFov(320, 240, 0.8);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  const ibr::Image8 picture =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  std::ofstream file(argv[4], std::ios::binary);
  file << "P6\n320 240\n255\n";
  for (std::size_t i = 0; i < picture.values.size(); i += 4)
    file.write(reinterpret_cast<const char*>(&picture.values[i]), 3);
  return file.flush() ? 0 : 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "consumer: %s\n", error.what());
  return 2;
}
