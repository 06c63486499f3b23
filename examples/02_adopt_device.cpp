// SPDX-License-Identifier: Apache-2.0
// An engine keeps its device, queue, images and command buffers; libibr only records. Draws the view of 01_offscreen.
//
//   02_adopt_device SCENE PICTURE.ppm
#include <ibr/ibr.h>

#include <cstdio>
#include <numbers>

#include "vulkan_helpers.h"

namespace {

// The engine chooses the physical device. This one takes the one that Device::create would take.
VkPhysicalDevice chosen(const helpers::Instance& instance) {
  const std::optional<ibr::DeviceDescription> preferred = ibr::Device::preferred();
  for (const VkPhysicalDevice device : instance.physicalDevices())
    if (preferred && ibr::Device::describe(device).name == preferred->name) return device;
  throw std::runtime_error("no Vulkan device has what libibr needs; 'ibr doctor' says why");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 02_adopt_device SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  constexpr VkExtent2D kSize{960, 540};

  // The engine creates instance and device, with what libibr needs beside its own extensions and features.
  const ibr::DeviceRequirements needs = ibr::Device::requirements();
  const helpers::Instance instance(needs.apiVersion, needs.instanceExtensions);
  const VkPhysicalDevice physicalDevice = chosen(instance);
  const std::uint32_t queueFamily = ibr::Device::describe(physicalDevice).queueFamily.value();
  ibr::DeviceFeatures features = ibr::Device::featuresFor(physicalDevice);
  const helpers::Device engine(physicalDevice, queueFamily, needs.deviceExtensions, features.link());
  const helpers::Image frame(engine.gpu, VK_FORMAT_R8G8B8A8_UNORM, kSize,
                             VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  const helpers::Buffer pixels(engine.gpu, 4 * kSize.width * kSize.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);

  // libibr borrows the handles. Its objects must go before the engine's device does.
  ibr::Device device = ibr::Device::adopt({.instance = instance.handle,
                                           .physicalDevice = physicalDevice,
                                           .device = engine.gpu.device,
                                           .queue = engine.gpu.queue,
                                           .queueFamily = queueFamily,
                                           .optionalFeatures = features});
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  const ibr::Renderer renderer(device, gpuScene, ibr::optionsFor(settings, kSize));

  ibr::Camera view = scene.nodes.at(0).camera;
  view.pose.position = (view.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});

  // The image's use before and after is part of the target, so the engine's barriers and those of libibr meet.
  const ibr::Target target{.image = frame.handle,
                           .view = frame.views[0],
                           .format = frame.format,
                           .extent = frame.extent,
                           .initialUse = ibr::use::kUndefined,
                           .finalUse = ibr::use::kTransferSource};
  helpers::submitAndWait(engine.gpu, [&](VkCommandBuffer commands) {
    if (gpuScene.needsStreaming()) gpuScene.stream(commands, plan, 1, 0);
    renderer.record(commands, plan, target);
    helpers::copyToBuffer(commands, frame, pixels);
  });

  helpers::writePpm(argv[2], pixels.data, kSize.width, kSize.height);
  std::printf("%s: drawn on %s\n", argv[2], device.name().c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "02_adopt_device: %s\n", error.what());
  return 2;
}
