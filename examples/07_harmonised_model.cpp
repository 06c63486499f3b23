// SPDX-License-Identifier: Apache-2.0
// Draws an object whose photographs are displaced until they agree ([H]). `ibr htm build` makes the model's folder.
//
//   07_harmonised_model MODEL PICTURE.ppm
//
// libibr reads a model without its pictures; the caller's decoder provides them. This one reads PNG files alone.
#include <ibr/ibr.h>
#include <png.h>

#include <cmath>
#include <cstdio>
#include <glm/trigonometric.hpp>

#include "vulkan_helpers.h"

namespace {

// RGB, or grey for one channel.
ibr::Image8 readPng(const std::filesystem::path& path, int channels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const bool opened = png_image_begin_read_from_file(&png, path.c_str()) != 0;
  ibr::Image8 image(int(png.width), int(png.height), channels);
  png.format = channels == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  if (!opened || !png_image_finish_read(&png, nullptr, image.values.data(), 0, nullptr))
    throw ibr::Error(ibr::ErrorCode::io, path.string() + ": " + png.message);
  return image;
}

ibr::HtmImage readPictures(const ibr::HtmModel& model, std::size_t index) {
  const ibr::HtmCamera& camera = model.cameras[index];
  ibr::HtmImage image{.photograph = readPng(model.folder / camera.imageFile, 3)};
  if (!camera.visibilityFile.empty()) image.visibility = readPng(model.folder / camera.visibilityFile, 1);
  return image;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 07_harmonised_model MODEL PICTURE.ppm\n", stderr);
    return 1;
  }
  constexpr VkExtent2D kSize{640, 480};
  ibr::Device device = ibr::Device::create();
  const ibr::HtmModel model = ibr::loadHtmModel(argv[1]);
  const ibr::GpuHtmModel gpuModel(device, model, readPictures);
  const ibr::HtmRenderer renderer(device, gpuModel, {.maxExtent = kSize});
  ibr::Offscreen offscreen(device, kSize);

  // The first camera, moved by 20° on its circle around the object.
  const ibr::HtmBounds bounds = ibr::htmBounds(model);
  ibr::Camera view = model.cameras.at(0).camera;
  const glm::dquat turn = glm::angleAxis(glm::radians(20.0), view.pose.rotation * glm::dvec3(0, 1, 0));
  view.pose.position = bounds.middle + turn * (view.pose.position - bounds.middle);
  view.pose.rotation = turn * view.pose.rotation;
  const double fovY = 2 * std::atan(0.5 * view.intrinsics.height / view.intrinsics.fy);
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), fovY);

  const ibr::HtmFramePlan plan = ibr::planHtmFrame(model, bounds, {view});
  const ibr::Image8 picture =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  helpers::writePpm(argv[2], picture.values.data(), kSize.width, kSize.height);
  std::printf("%s: %zu cameras, best %s\n", argv[2], plan.cameras.size(),
              model.cameras[plan.cameras.at(0).camera].name.c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "07_harmonised_model: %s\n", error.what());
  return 2;
}
