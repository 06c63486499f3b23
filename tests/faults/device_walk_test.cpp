// SPDX-License-Identifier: Apache-2.0
// Fails the N-th Vulkan call, N = 1, 2, … until none is left, in every use of a device. The validation layer reports
// leaks when the device is destroyed.
#include <catch2/catch.hpp>
#include <cstdio>
#include <optional>

#include "base/vulkan/submit.h"
#include "gpu/draw/multiview.h"
#include "ibr/htm.h"
#include "ibr/optimiser.h"
#include "ibr/template_search_pass.h"
#include "small_place.h"
#include "support/bumpy_model.h"
#include "support/gpu.h"
#include "support/hand_executor.h"
#include "support/planted.h"
#include "support/vulkan_faults.h"

using namespace ibr;
using namespace ibr::test;

namespace {

Device newDevice() {
  return Device::create({.validation = true, .log = testLog()});
}

/// Prints the number of failed calls (libibr/docs/faults.md); shown with --success.
void tell(const char* what, WalkedFaults walked) {
  std::printf("%s: %d calls failed, %d recovered\n", what, walked.failures, walked.madeGood);
}

template <class Call>
WalkedFaults outOfMemory(const char* what, Call call, bool mayMakeGood = false, int step = 1) {
  const WalkedFaults walked =
      failEachCall(VK_ERROR_OUT_OF_DEVICE_MEMORY, ErrorCode::outOfMemory, call, mayMakeGood, step);
  tell(what, walked);
  return walked;
}

/// Compares without Catch's expression decomposition, because CHECK would retain exceptions thrown by the operands.
template <class T>
void expectSame(const T& made, const T& expected) {
  CHECK((made == expected));
}

struct Look {
  const char* name;
  RenderSettings settings;
  int step = 7;  // its pipelines compile slowly, and again for each failure behind them
  std::uint32_t views = 1;
};

std::vector<Look> looks() {
  std::vector<Look> all{{"plain", {}},
                        {"colours", {}, 11},
                        {"colours of the paper", {}, 29},
                        {"paper, drawn again", {}, 31},
                        {"overlay, floor, hidden area", {}, 17},
                        {"filled", {}},
                        {"stereo", {}, 11, 2},
                        {"gathered", {}, 11},
                        {"gathered where cells leave holes", {}, 17, 2},
                        {"overlay of what is gathered", {}, 17}};
  for (Look& look : all) {
    look.settings.maxTier = kTierCompleted;
    look.settings.switchSeconds = 0;
  }
  all[1].settings.colourMapping = ColourMapping::ours;
  all[2].settings.colourMapping = ColourMapping::paper;
  all[3].settings.colourMapping = ColourMapping::paperRedraw;
  all[4].settings.overlay = Overlay::confidence;
  all[4].settings.floor = Floor{.height = -1};
  all[5].settings.maxTier = kTierFilled;
  all[5].settings.switchSeconds = 0.25;
  all[5].settings.blend = BlendMode::dither;
  all[7].settings.composition = Composition::gathered;
  all[8].settings.composition = Composition::hybrid;
  all[9].settings.composition = Composition::gathered;
  all[9].settings.overlay = Overlay::tiers;
  return all;
}

}  // namespace

TEST_CASE("a scene can be opened and rendered after a failure of any Vulkan call", "[P10]") {
  const SmallScene place;
  Device device = newDevice();
  const FramePlan plan = place.plan({});
  const auto show = [&] { return place.pictures(device, place.open(device), plan); };
  const std::vector<Image8> expected = show();
  const WalkedFaults walked = outOfMemory(
      "open and show", [&] { expectSame(show(), expected); }, false, 2);
  CHECK(walked.failures > 60);
}

TEST_CASE("a scene made with uploads can be opened after a failure of any Vulkan call, which leaves no uploads",
          "[P10]") {
  const SmallScene place;
  Device device = newDevice();
  const FramePlan plan = place.plan({});
  const Image8 expected = place.pictures(device, place.open(device), plan)[0];
  const auto show = [&] {
    Uploads uploads(device);
    std::optional<GpuScene> scene;
    try {
      scene.emplace(place.open(device, {.uploads = &uploads}));
    } catch (const Error&) {
      CHECK(uploads.empty());
      CHECK(uploads.bytes() == 0);
      throw;
    }
    RendererOptions options = optionsFor(plan.settings, {48, 36});
    options.uploads = &uploads;
    const std::uint64_t bytes = uploads.bytes();
    std::optional<Renderer> renderer;
    try {
      renderer.emplace(device, *scene, options);
    } catch (const Error&) {
      CHECK(uploads.bytes() == bytes);
      throw;
    }
    Offscreen offscreen(device, {48, 36});
    return offscreen.render([&](VkCommandBuffer commands) {
      uploads.record(commands);
      renderer->record(commands, plan, offscreen.target());
    });
  };
  const WalkedFaults walked = outOfMemory(
      "open with uploads", [&] { expectSame(show(), expected); }, false, 5);
  CHECK(walked.failures > 20);
}

TEST_CASE("multiview can be probed after a failure of any Vulkan call", "[P10]") {
  const Device device = newDevice();
  if (!device.supportsMultiview()) return;
  const bool works = runMultiviewProbe(device);
  const WalkedFaults walked = outOfMemory("multiview probe", [&] { expectSame(runMultiviewProbe(device), works); });
  CHECK(walked.failures > 10);
}

TEST_CASE("every pass can be created and drawn after a failure of any Vulkan call") {
  const SmallScene place;
  Device device = newDevice();
  const GpuScene scene = place.open(device);
  const Look look = GENERATE(from_range(looks()));
  CAPTURE(look.name);
  const FramePlan plan = place.plan(look.settings, look.views);
  const std::vector<Image8> expected = place.pictures(device, scene, plan);
  const WalkedFaults walked = outOfMemory(
      look.name, [&] { expectSame(place.pictures(device, scene, plan), expected); }, false, look.step);
  CHECK(walked.failures > 4);
}

TEST_CASE("buffers can be rendered and read after a failure of any Vulkan call") {
  const SmallScene place;
  Device device = newDevice();
  const GpuScene scene = place.open(device);
  const FramePlan plan = place.plan({});
  const auto show = [&] {
    RendererOptions options = optionsFor(plan.settings, {48, 36});
    options.bufferScene = &place.scene();
    const Renderer renderer(device, scene, options);
    OffscreenBuffers buffers(device, {48, 36});
    return buffers
        .render([&](VkCommandBuffer commands) { renderer.recordBuffers(commands, plan, 0, buffers.targets()); })
        .surface;
  };
  const ImageF expected = show();
  CHECK(outOfMemory(
            "buffers", [&] { expectSame(show(), expected); }, false, 7)
            .failures > 4);
}

TEST_CASE("a failed resize leaves the previous renderer unchanged") {
  const SmallScene place;
  Device device = newDevice();
  const GpuScene scene = place.open(device);
  const FramePlan small = place.plan({}), large = place.plan({}, 1, 96, 72);
  struct View {
    Renderer renderer;
    Offscreen offscreen;
    Image8 show(const FramePlan& plan) {
      return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
    }
  };
  const auto make = [&](VkExtent2D extent) {
    return View{Renderer(device, scene, optionsFor({}, extent)), Offscreen(device, extent)};
  };
  View view = make({48, 36});
  const Image8 expected = view.show(small), largeExpected = make({96, 72}).show(large);
  const WalkedFaults walked = outOfMemory(
      "resize",
      [&] {
        try {
          View resized = make({96, 72});
          expectSame(resized.show(large), largeExpected);
        } catch (const Error&) {
          failNothing();
          expectSame(view.show(small), expected);
          throw;
        }
      },
      false, 5);
  CHECK(walked.failures > 8);
}

TEST_CASE("photographs can be streamed after a failure of any Vulkan call") {
  const SmallScene place;
  Device device = newDevice();
  const FramePlan plan = place.plan({});
  const std::uint64_t all = place.open(device).memory().sum();
  const bool inJobs = GENERATE(false, true);  // texture arrays are made and destroyed on another thread
  const auto show = [&] {
    HandExecutor hand;
    GpuSceneOptions options{.budgetBytes = all - 1, .readerThreads = inJobs ? 2u : 0u};
    if (inJobs) options.executor = hand.executor();
    GpuScene scene = place.open(device, options);
    Renderer renderer(device, scene, optionsFor({}, {48, 36}));
    Offscreen offscreen(device, {48, 36});
    Image8 picture;
    for (std::uint64_t frame = 1; frame < 8; ++frame) {
      picture = offscreen.render([&](VkCommandBuffer commands) {
        scene.stream(commands, plan, frame, frame - 1);
        renderer.record(commands, plan, offscreen.target());
      });
      hand.runAll();
      CHECK(scene.memory().sum() <= all - 1);
    }
    return picture;
  };
  const Image8 expected = show();
  // A failure while photographs stream lowers the budget, and stand-ins may remain.
  const WalkedFaults walked = outOfMemory(
      inJobs ? "stream, in jobs" : "stream",
      [&] {
        const Image8 picture = show();
        if (!failedCall()) CHECK((picture == expected));
      },
      true, 7);
  CHECK(walked.failures > 30);
}

TEST_CASE("allocated bytes stay within the budget, staging excluded", "[P10]") {
  const SmallScene place;
  Device device = newDevice();
  const FramePlan plan = place.plan({});
  const std::uint64_t all = place.open(device).memory().sum(), staging = 1 << 20;
  const std::uint64_t before = deviceMemory().bytes;
  for (const std::uint64_t budget : {all, all - 1, all * 9 / 10}) {
    CAPTURE(budget, all);
    resetMost();
    GpuScene scene = place.open(device, {.budgetBytes = budget, .stagingBytes = staging, .readerThreads = 0});
    for (std::uint64_t frame = 1; frame < 8; ++frame) {
      submitAndWait(device, [&](VkCommandBuffer commands) { scene.stream(commands, plan, frame, frame - 1); });
      CHECK(scene.memory().sum() <= budget);
      CHECK(deviceMemory().bytes - before <= budget + (scene.needsStreaming() ? staging : 0));
    }
    CHECK(scene.memory().sum() <= deviceMemory().bytes - before);
    CHECK(deviceMemory().most - before <= budget + 2 * staging);
  }
  CHECK(deviceMemory().bytes == before);
}

TEST_CASE("matches are aligned on a device, or stay unchanged if any Vulkan call fails") {
  const auto method = GENERATE(AlignmentMethod::compute, AlignmentMethod::raster);
  const Device device = newDevice();
  if (!(method == AlignmentMethod::compute ? device.supportsInt64() : device.supportsInt64Atomics())) return;
  const AlignmentOptions options{.method = method, .instances = 8, .maxCycles = 1};
  Planted exact = planted(2, 40, 2, 2.0, 11);
  const auto before = exact.alignment.position;
  align(exact.alignment, options, &device);
  const WalkedFaults walked = outOfMemory(
      method == AlignmentMethod::compute ? "align, compute" : "align, raster",
      [&] {
        Planted again = planted(2, 40, 2, 2.0, 11);
        try {
          align(again.alignment, options, &device);
        } catch (const Error&) {
          CHECK((again.alignment.position == before));
          throw;
        }
        CHECK((again.alignment.position == exact.alignment.position));
      },
      false, method == AlignmentMethod::compute ? 13 : 7);
  CHECK(walked.failures > 8);
}

TEST_CASE("a harmonised model can be opened, rendered and replaced after a failure of any Vulkan call") {
  const auto method = GENERATE(HtmMethod::harmonised, HtmMethod::vertexColours);
  Device device = newDevice();
  const BumpyModel bumpy = bumpyModel({.cameras = 3, .width = 40, .height = 30, .longitudes = 8, .latitudes = 6});
  Camera view = ringCamera(bumpy.options, 0.3);
  HtmSettings settings;
  settings.method = method;
  const HtmFramePlan plan = planHtmFrame(bumpy.model, htmBounds(bumpy.model), {view, settings});
  const VkExtent2D extent{std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
  const auto show = [&] {
    GpuHtmModel model(device, bumpy.model, bumpy.source());
    HtmRenderer renderer(device, model, {.maxExtent = extent});
    Offscreen offscreen(device, extent);
    const auto record = [&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); };
    const Image8 first = offscreen.render(record);
    model.replace(bumpy.model, bumpy.source());
    renderer.setModel(model);
    expectSame(offscreen.render(record), first);
    return first;
  };
  const Image8 expected = show();
  CHECK(outOfMemory(
            "harmonised model", [&] { expectSame(show(), expected); }, false, 5)
            .failures > 20);
}

TEST_CASE("templates can be searched after a failure of any Vulkan call", "[P10]") {
  const Device device = newDevice();
  const Image8 picture = planted(2, 40, 2, 2.0, 11).pictures[0];
  std::vector<TemplateSample> samples;
  for (int k = 0; k < 25; ++k) {
    const auto p = picture.pixel(12 + k % 5, 12 + k / 5);
    samples.push_back({std::int16_t(10 + k % 5), std::int16_t(13 + k / 5), p[0], p[1], p[2]});
  }
  const std::vector<TemplateTask> tasks{{0, 0, 25, {}}};
  const WalkedFaults walked = outOfMemory("template search", [&] {
    const Image8* const pictures[] = {&picture};
    const TemplateSearch search = deviceTemplateSearch(device)(pictures);
    expectSame(search(tasks, samples, 4, TemplateMeasure::absoluteDifferences)[0].displacement, {2, -1});
  });
  CHECK(walked.failures > 20);
}

TEST_CASE("a device with a pipeline cache is created completely or not at all") {
  const WalkedFaults walked = outOfMemory("device", [] { newDevice(); });
  CHECK(walked.failures >= 4);
}

TEST_CASE("an unknown fault of any Vulkan call throws Error{vulkan} that names the call") {
  const SmallScene place;
  Device device = newDevice();
  const FramePlan plan = place.plan({});
  const WalkedFaults walked = failEachCall(
      VK_ERROR_UNKNOWN, ErrorCode::vulkan,
      [&] { expectSame(place.pictures(device, place.open(device), plan)[0].width, 48); }, false, 2);
  tell("unknown faults", walked);
  CHECK(walked.failures > 60);
}
