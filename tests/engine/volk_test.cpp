// SPDX-License-Identifier: Apache-2.0
// An engine that uses volk passes its vkGetInstanceProcAddr and its device to libibr.
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>

#include "ibr/ibr.h"
#include "lab/generate/synthetic.h"
#include "support/skipped.h"
#include "volk_engine.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;

bool deviceIsThere() {
  if (Device::preferred()) return true;
  const char* required = std::getenv("IBR_REQUIRE_DEVICE");
  if (required && *required) FAIL("no Vulkan device");
  return skipCase("no Vulkan device");
}

SyntheticScene makePlace() {
  SyntheticOptions options;
  for (const double x : {-0.5, 0.5}) {
    Camera camera;
    camera.intrinsics = pinholeFromFov(kWidth, kHeight, 1);
    camera.pose.position = {x, 0, 0};
    options.cameras.push_back(camera);
  }
  options.planes = {{{0, 0, -5}, {1, 0, 0}, {0, 1, 0}, 20, 20, 1, 0.5}};
  return makeScene(options);
}

/// The place as seen from between its cameras.
Image8 render(Device& device, const SyntheticScene& place) {
  GpuSceneOptions options;
  options.source = [&](const Scene&, std::size_t node, int firstLevel) {
    return withoutLargestLevels(buildMips(place.photographs[node]), firstLevel);
  };
  const GpuScene gpuScene(device, place.scene, options);
  const VkExtent2D extent{kWidth, kHeight};
  const Renderer renderer(device, gpuScene, {extent});
  Offscreen offscreen(device, extent);
  Camera view = place.scene.nodes.at(0).camera;
  view.pose.position = {0, 0, 0};
  const FramePlan plan = planFrame(place.scene, sceneBounds(place.scene), {{view}, {}});
  return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

}  // namespace

TEST_CASE("an engine that uses volk gets the same image as a device of libibr") {
  if (!deviceIsThere()) return;
  const SyntheticScene place = makePlace();
  Image8 expected;
  std::string name;
  {
    Device device = Device::create();
    expected = render(device, place);
    name = device.properties().deviceName;
  }
  std::set<std::uint8_t> reds;
  for (int x = 0; x < kWidth; ++x) reds.insert(expected.pixel(x, kHeight / 2)[0]);
  REQUIRE(reds.size() > 10);  // textured

  const VolkEngine engine(name);
  Device::loadFunctions(vkGetInstanceProcAddr, engine.instance());
  {
    Device adopted = Device::adopt(engine.handles());
    CHECK((render(adopted, place) == expected));
    CHECK(adopted.validationMessages() == 0);
  }
  {
    Device owned = Device::create({.device = name});  // another instance, with the same functions
    CHECK((render(owned, place) == expected));
  }
  CHECK(engine.validationMessages() == 0);
}

TEST_CASE("libibr makes its own device with volk's functions") {
  if (!deviceIsThere()) return;
  const SyntheticScene place = makePlace();
  REQUIRE(volkInitialize() == VK_SUCCESS);
  Image8 first;
  for (int i = 0; i < 2; ++i) {
    Device::loadFunctions(vkGetInstanceProcAddr);  // global functions; the rest come from the first instance
    Device device = Device::create();
    const Image8 picture = render(device, place);
    if (i == 0) first = picture;
    CHECK((picture == first));
  }
}
