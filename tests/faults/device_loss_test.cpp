// SPDX-License-Identifier: Apache-2.0
// A device that is lost stays lost: from then on every call that hands it work or waits for it throws deviceLost. The
// Scene is untouched: what is made anew of it shows the same.
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

TEST_CASE("lost at any time, a device stays so for every call, and the scene comes back on a new one") {
  const SmallPlace place;
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
        if (scene->streams()) scene->stream(commands, plan, 1, 0);
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
    // Whatever is asked of it from now on.
    expectLost("open", [&] { place.open(device); });
    if (offscreen) expectLost("show again", [&] { show(renderer, offscreen); });
    if (device.counts64Bits())
      expectLost("align", [&] {
        Planted planted = test::planted(2, 40, 2, 2.0, 11);
        align(planted.alignment, {.method = AlignmentMethod::compute, .instances = 8, .mostCycles = 1}, &device);
      });
    // Also what only makes objects.
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
    // The lost device goes, with all that was made from it, and another one takes its place.
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
