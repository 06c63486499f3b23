// SPDX-License-Identifier: Apache-2.0
// One thread renders frames while another loads a scene on the same VkDevice; each thread has its own Device.
#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <mutex>
#include <thread>

#include "reference/stage.h"
#include "support/gpu.h"
#include "support/handmade_device.h"

using namespace ibr;
using namespace ibr::test;

TEST_CASE("frames are drawn while another thread uploads a scene") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Camera view = cameraAt({0.45, 0.3, 0.2}, 0.05);
  const Image8 expected = Stage(testDevice(), makeScene(options)).render(view);

  const HandmadeDevice handmade;
  std::mutex queue;
  DeviceHandles handles = handmade.handles();
  handles.queueMutex = &queue;
  Device frames = Device::adopt(handles), loading = Device::adopt(handles);
  const Stage shown(frames, makeScene(options));
  std::unique_ptr<Stage> loaded;
  std::atomic<bool> done = false;
  std::thread loader([&] {
    for (int i = 0; i < 3; ++i) loaded = std::make_unique<Stage>(loading, makeScene(options));
    done = true;
  });
  int different = 0;
  do {
    different += shown.render(view) != expected;
  } while (!done);
  loader.join();
  CHECK(different == 0);
  // This thread's device renders frames of the other thread's scene.
  const VkExtent2D extent{320, 240};
  const Renderer renderer(frames, loaded->gpuScene(), {extent});
  Offscreen offscreen(frames, extent);
  const FramePlan plan = shown.plan(view);
  CHECK((offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); }) ==
         expected));
  CHECK(frames.validationMessages() == 0);
}
