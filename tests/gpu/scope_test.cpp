// SPDX-License-Identifier: Apache-2.0
#include "ibr/scope_timer.h"

#include <catch2/catch.hpp>

#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "support/gpu.h"
#include "support/skipped.h"
#include "test_picture.h"

using namespace ibr;
using test::testDevice;

namespace {

bool hasTimestamps() {
  return testDevice().properties().limits.timestampComputeAndGraphics || test::skipCase("no timestamps");
}

}  // namespace

TEST_CASE("scopes nest, and no scope lasts longer than its parent") {
  if (!hasTimestamps()) return;
  const Buffer buffer(testDevice(), 1 << 20, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device, "filled");
  ScopeTimer timer(testDevice(), 8);
  const auto fill = [&](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, buffer.get(), 0, VK_WHOLE_SIZE, 1);
    bufferBarrier(commands, use::kTransferWrite, use::kTransferWrite);
  };
  for (int repetition = 0; repetition < 2; ++repetition) {
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      timer.reset(commands);
      const GpuScope frame(commands, &timer, "frame");
      {
        const GpuScope first(commands, &timer, "first");
        fill(commands);
        const GpuScope inner(commands, &timer, "inner");
        fill(commands);
      }
      const GpuScope second(commands, &timer, "second");
      fill(commands);
    });
    const auto times = timer.read();
    REQUIRE(times.size() == 4);
    const char* const names[]{"frame", "first", "inner", "second"};
    const int depths[]{0, 1, 2, 1};
    for (int i = 0; i < 4; ++i) {
      CHECK(times[i].name == names[i]);
      CHECK(times[i].depth == depths[i]);
      CHECK(times[i].milliseconds >= 0.0);
    }
    const double slack = 1e-6;  // rounding of added doubles; the ticks themselves are ordered
    CHECK(times[0].milliseconds > 0.0);
    CHECK(times[2].milliseconds <= times[1].milliseconds + slack);
    CHECK(times[1].milliseconds + times[3].milliseconds <= times[0].milliseconds + slack);
  }
}

TEST_CASE("scopes work inside the canvas' pass") {
  if (!hasTimestamps()) return;
  const Canvas canvas(testDevice(), {8, 8});
  ScopeTimer timer(testDevice(), 2);
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    timer.reset(commands);
    const GpuScope pass(commands, &timer, "pass");
    canvas.begin(commands, {8, 8}, {});
    { const GpuScope nothing(commands, &timer, "nothing"); }
    canvas.end(commands);
  });
  const auto times = timer.read();
  REQUIRE(times.size() == 2);
  CHECK(times[1].milliseconds <= times[0].milliseconds + 1e-6);
}

TEST_CASE("scopes beyond the capacity are not timed and leave the other times correct") {
  if (!hasTimestamps()) return;
  ScopeTimer timer(testDevice(), 2);
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    timer.reset(commands);
    const GpuScope a(commands, &timer, "a");
    { const GpuScope b(commands, &timer, "b"); }
    const GpuScope c(commands, &timer, "c");
    const GpuScope d(commands, &timer, "d");
  });
  const auto times = timer.read();
  REQUIRE(times.size() == 2);
  CHECK(times[0].name == "a");
  CHECK(times[1].name == "b");
}

TEST_CASE("scopes that were not submitted have no time") {
  ScopeTimer timer(testDevice(), 2);
  CHECK(timer.read().empty());
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { timer.reset(commands); });
  CHECK(timer.read().empty());
}

TEST_CASE("scopes record with a moved timer of capacity 0 and without a timer") {
  ScopeTimer labels(testDevice(), 0);
  ScopeTimer moved = std::move(labels);
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    moved.reset(commands);
    const GpuScope a(commands, &moved, "a");
    const GpuScope b(commands, nullptr, "b");
  });
  CHECK(moved.read().empty());
}
