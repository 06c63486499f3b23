// SPDX-License-Identifier: Apache-2.0
// Aligns the photographs inside the meshes of a scene's cells ([T] chapter 3), in memory. Draws the same view with the
// meshes as they were built, and as they are optimised.
//
//   06_optimise_mesh SCENE PICTURE.ppm      writes both pictures side by side
//
// Needs ibr::author, since depths are computed again from the moved matches. The optimiser itself is ibr/optimiser.h.
#include <ibr/author/optimise_scene.h>
#include <ibr/ibr.h>

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "vulkan_helpers.h"

namespace {

constexpr VkExtent2D kSize{640, 480};

ibr::Image8 rendered(ibr::Device& device, const ibr::Scene& scene) {
  const ibr::GpuScene gpuScene(device, scene);
  ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  settings.composition = ibr::Composition::cells;  // the optimiser leaves the photographs' own depth alone
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, kSize));
  ibr::Offscreen offscreen(device, kSize);

  // Halfway between the photographs, both are displaced the most, and errors show as ghosts.
  const std::vector<std::uint32_t>& members = scene.cells.at(0).members;
  ibr::Camera view = scene.nodes[members[0]].camera;
  view.pose.position = (view.pose.position + scene.nodes[members[1]].camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 6);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});
  return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 06_optimise_mesh SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::Image8 before = rendered(device, scene);

  // The device and the processor give the same mesh.
  ibr::OptimiseCellsOptions options;
  options.alignment.method = device.supportsInt64() ? ibr::AlignmentMethod::compute : ibr::AlignmentMethod::cpu;
  const ibr::Aligner aligner = [&](ibr::Alignment& alignment, const ibr::AlignmentOptions& o,
                                   const ibr::ProgressCallback& progress) {
    return ibr::align(alignment, o, &device, progress);
  };
  const ibr::OptimiseSceneReport report = ibr::optimiseCells(scene, options, aligner);
  for (const ibr::OptimisedCell& cell : report.cells)
    std::printf("cell %zu: %zu of %zu points moved, ECC %.4f, before %.4f\n", cell.cell, cell.moved, cell.points,
                cell.summary.finalEcc, cell.summary.initialEcc);
  const ibr::Image8 after = rendered(device, scene);  // saveScene would store the scene

  ibr::Image8 both(before.width + after.width, before.height, before.channels);
  const std::ptrdiff_t row = std::ptrdiff_t(before.width) * before.channels;
  for (int y = 0; y < before.height; ++y) {
    std::copy_n(before.values.begin() + y * row, row, both.values.begin() + 2 * y * row);
    std::copy_n(after.values.begin() + y * row, row, both.values.begin() + (2 * y + 1) * row);
  }
  helpers::writePpm(argv[2], both.values.data(), 2 * kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "06_optimise_mesh: %s\n", error.what());
  return 2;
}
