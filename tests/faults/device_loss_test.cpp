// SPDX-License-Identifier: Apache-2.0
// A lost device stays lost: every later call that submits work or waits throws deviceLost. The Scene is unaffected: a
// GpuScene made from it on a new device shows the same images.
#include <catch2/catch.hpp>
#include <cstdio>
#include <optional>

#include "ibr/htm.h"
#include "ibr/optimiser.h"
#include "ibr/template_search_pass.h"
#include "small_place.h"
#include "support/bumpy_model.h"
#include "support/gpu.h"
#include "support/planted.h"
#include "support/vulkan_faults.h"

using namespace ibr;
using namespace ibr::test;

namespace {

template <class Call>
void expectLost(const char* what, Call call) {
  INFO(what);
  try {
    call();
    FAIL_CHECK("no error");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::deviceLost);
    CHECK_THAT(error.what(), Catch::Contains("VK_ERROR_DEVICE_LOST"));
  }
}

}  // namespace

TEST_CASE("a device lost at any call stays lost, and the scene renders again on a new device") {
  const SmallScene place;
  const DeviceOptions options{.validation = true, .log = testLog()};
  const FramePlan plan = place.plan({});
  std::optional<Image8> expected;
  int losses = 0;
  for (;; ++losses) {
    Device device = Device::create(options);
    std::optional<GpuScene> scene;
    std::optional<Renderer> renderer;
    std::optional<Offscreen> offscreen;
    const auto show = [&](const std::optional<Renderer>& by, std::optional<Offscreen>& into) {
      return into->render([&](VkCommandBuffer commands) {
        if (scene->needsStreaming()) scene->stream(commands, plan, 1, 0);
        by->record(commands, plan, into->target());
      });
    };
    loseDevice(losses);
    try {
      scene.emplace(place.open(device));
      renderer.emplace(device, *scene, optionsFor({}, {48, 36}));
      offscreen.emplace(device, VkExtent2D{48, 36});
      const Image8 picture = show(renderer, offscreen);
      if (!expected) expected = picture;
      CHECK((picture == *expected));
      const Image8 again = show(renderer, offscreen);
      CHECK((again == *expected));
      if (!failedCall()) break;
      FAIL_CHECK("no error");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::deviceLost);
      CHECK_THAT(error.what(), Catch::Contains(failedCall()));
    }
    CHECK(device.isLost());
    // All later requests to the lost device fail.
    expectLost("open", [&] { place.open(device); });
    if (offscreen) expectLost("show again", [&] { show(renderer, offscreen); });
    if (device.supportsInt64())
      expectLost("align", [&] {
        Planted planted = test::planted(2, 40, 2, 2.0, 11);
        align(planted.alignment, {.method = AlignmentMethod::compute, .instances = 8, .maxCycles = 1}, &device);
      });
    // Functions that only create objects fail as well.
    expectLost("offscreen", [&] { Offscreen(device, VkExtent2D{8, 8}); });
    if (scene) expectLost("renderer", [&] { Renderer(device, *scene, optionsFor({}, {48, 36})); });
    expectLost("harmonised model", [&] {
      const BumpyModel bumpy = bumpyModel({.cameras = 2, .width = 40, .height = 30, .longitudes = 8, .latitudes = 6});
      GpuHtmModel(device, bumpy.model, bumpy.source());
    });
    expectLost("template search", [&] {
      const Image8 picture(40, 40, 3);
      const Image8* const pictures[] = {&picture};
      deviceTemplateSearch(device)(pictures);
    });
    // The lost device is destroyed with all its objects, and a new device replaces it.
    offscreen.reset();
    renderer.reset();
    scene.reset();
    failNothing();
    device = Device::create(options);
    const Image8 again = place.pictures(device, place.open(device), plan)[0];
    if (!expected) expected = again;
    CHECK((again == *expected));
  }
  std::printf("lost at %d calls\n", losses);
  failNothing();
  CHECK(losses >= 5);
}
