// SPDX-License-Identifier: Apache-2.0
// Streaming on other threads: frames go on while photographs are read, and nothing depends on when they arrive.
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "reference/grid_walk.h"
#include "render/resident/streamer.h"
#include "render/resident/wanted_items.h"
#include "support/error_of.h"
#include "support/gate.h"
#include "support/gpu.h"
#include "support/hand_executor.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kSide = 12;                     // photographs along a side of the grid
constexpr int kPx = 256;                      // side of a photograph
constexpr std::uint64_t kBudget = 32 * kMiB;  // for half of the photographs; texture arrays of five layers

bool isStreamed(const Scene& scene, std::size_t node, int firstLevel) {
  return (scene.nodes[node].camera.intrinsics.width >> firstLevel) > Colours::kMaxStandInSide;
}

/// Calls `before` for each read of a photograph that is streamed, on the reading thread.
template <class Before>
TextureSource watched(Before before) {
  return [before](const Scene& scene, std::size_t node, int firstLevel) {
    if (isStreamed(scene, node, firstLevel)) before(node);
    return Colours{}(scene, node, firstLevel);
  };
}

class Reads {
 public:
  TextureSource source() {
    return watched([this](std::size_t node) {
      const std::lock_guard lock(mutex_);
      nodes_.push_back(node);
      threads_.insert(std::this_thread::get_id());
    });
  }
  std::vector<std::size_t> nodes() {
    const std::lock_guard lock(mutex_);
    return nodes_;
  }
  std::set<std::thread::id> threads() {
    const std::lock_guard lock(mutex_);
    return threads_;
  }

 private:
  std::mutex mutex_;
  std::vector<std::size_t> nodes_;
  std::set<std::thread::id> threads_;
};

Image8 frameUntilLoaded(Walker& walker, const FramePlan& plan) {
  Image8 image;
  do image = walker.frame(plan);
  while (walker.streamed.waiting > 0);
  return image;
}

}  // namespace

TEST_CASE("frames show stand-ins while a source blocks, and the photographs once they have been read") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  Gate gate;
  Walker walker(scene, {.source = watched([&](std::size_t) { gate.pass(); }), .budgetBytes = kBudget}, {64, 64});
  const FramePlan plan = walker.planAt({2, 0, 2});
  const std::size_t node = 2 * kSide + 2;
  CHECK(sharesOf(walker.frame(plan), node).standIn > 0.99);
  const bool arrived = gate.waitForArrivals(2);  // both threads read
  for (int frame = 0; frame < 5; ++frame) {
    CHECK(sharesOf(walker.frame(plan), node).standIn > 0.99);
    CHECK(walker.streamed.waiting == walker.streamed.needed);
    CHECK(walker.streamed.reading == 2);
    CHECK(walker.streamed.queued >= 3);  // the other layers of an array
    CHECK(walker.streamed.queued + walker.streamed.reading <= maxLoads(2));
    CHECK(walker.uploaded == 0);
  }
  gate.open();
  REQUIRE(arrived);
  CHECK(sharesOf(frameUntilLoaded(walker, plan), node).own > 0.99);
  CHECK(walker.streamed.overBudget == 0);
}

TEST_CASE("no photograph is read on the thread that streams, and memory stays within the budget on a walk") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  const bool ownThreads = GENERATE(true, false);
  Reads reads;
  HandExecutor hand;
  GpuSceneOptions options{.source = reads.source(), .budgetBytes = 12 * kMiB};
  if (!ownThreads) options.executor = hand.executor();
  Walker walker(scene, options, {64, 64});
  REQUIRE(walker.gpuScene.needsStreaming());
  for (int f = 0; f < 60; ++f) {
    const double along = f * 11 / 59.0;
    CHECK(emptyPixels(walker.frame(walker.planAt({along, 0, along}))) == 0);
    CHECK(walker.most <= 12 * kMiB);
    hand.runAll();
  }
  for (int frame = 0; frame == 0 || walker.streamed.waiting > 0; ++frame) {
    walker.frame(walker.planAt({11, 0, 11}));
    hand.runAll();
  }
  CHECK(sharesOf(walker.frame(walker.planAt({11, 0, 11})), 143).own > 0.99);
  CHECK(walker.most <= 12 * kMiB);
  CHECK_FALSE(reads.nodes().empty());
  CHECK_FALSE(reads.threads().contains(std::this_thread::get_id()));
}

TEST_CASE("the most urgent photographs of the last frame are read first, and those left behind are not read") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  Reads reads;
  HandExecutor hand;
  Walker walker(scene,
                {.source = reads.source(), .budgetBytes = kBudget, .readerThreads = 1, .executor = hand.executor()},
                {64, 64});
  const FramePlan there = walker.planAt({0, 0, 0}), here = walker.planAt({4, 0, 4});
  walker.frame(there);
  CHECK(walker.streamed.queued == 5);  // the layers of the array that is about to be made
  CHECK(hand.jobs.size() == 1);
  walker.frame(here);
  CHECK(walker.streamed.queued == 5);
  CHECK(hand.jobs.size() == 1);  // it runs all queued jobs
  hand.runAll();
  WantedItems wanted(scene, std::vector<bool>(StreamItems(scene).count(), false));
  wanted.update(here, 5);
  CHECK(reads.nodes() == std::vector<std::size_t>(wanted.items().begin(), wanted.items().begin() + 5));
}

TEST_CASE("photographs that were read in vain are read again when they are needed") {
  const Scene scene = gridScene(8, 512, 512);
  Gate gate;
  std::atomic<int> blocked = 0;
  const auto source = watched([&](std::size_t node) {
    if (node > 1 || blocked++ > 0) return;
    gate.pass();
  });
  Walker walker(scene, {.source = source, .budgetBytes = 14 * kMiB, .readerThreads = 1}, {64, 64});
  const FramePlan first = walker.planAt({0, 0, 0}), second = walker.planAt({7, 0, 7});
  walker.frame(first);
  const bool arrived = gate.waitForArrivals(1);
  walker.frame(second);  // room for a few photographs only: those of the first plan are not wanted
  walker.frame(second);
  CHECK(walker.streamed.waiting > 0);
  gate.open();
  REQUIRE(arrived);
  CHECK(sharesOf(frameUntilLoaded(walker, second), 63).own > 0.99);
  CHECK(sharesOf(frameUntilLoaded(walker, first), 0).own > 0.99);
  CHECK(walker.most <= 14 * kMiB);
}

TEST_CASE("a photograph that cannot be read on another thread is reported once, by a frame") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  const std::size_t broken = 1 * kSide + 1, worse = 1 * kSide + 2;
  const auto source = watched([&](std::size_t node) {
    if (node == broken) throw Error(ErrorCode::io, "1-1.ktx2: gone");
    if (node == worse) throw std::runtime_error("2-1.ktx2: not an Error");
  });
  std::vector<std::string> errors;
  std::set<std::thread::id> threads;
  const auto log = [&](LogLevel level, std::string_view text) {
    threads.insert(std::this_thread::get_id());
    if (level == LogLevel::error) errors.emplace_back(text);
  };
  Walker walker(scene, {.source = source, .budgetBytes = kBudget, .log = log}, {64, 64});
  const FramePlan plan = walker.planAt({1, 0, 1});
  CHECK(sharesOf(frameUntilLoaded(walker, plan), broken).standIn > 0.99);
  for (int frame = 0; frame < 3; ++frame) walker.frame(plan);
  CHECK(walker.streamed.failed == 2);
  REQUIRE(errors.size() == 2);
  CHECK_THAT(errors[0] + errors[1], Catch::Contains("1-1.ktx2: gone") && Catch::Contains("2-1.ktx2: not an Error"));
  CHECK(threads == std::set{std::this_thread::get_id()});
}

TEST_CASE("jobs of a destroyed scene have no effect") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  Reads reads;
  HandExecutor hand;
  {
    Walker walker(scene, {.source = reads.source(), .budgetBytes = kBudget, .executor = hand.executor()}, {64, 64});
    walker.frame(walker.planAt({2, 0, 2}));
    CHECK(hand.jobs.size() == 2);
  }
  hand.runAll();
  CHECK(reads.nodes().empty());
}

TEST_CASE("a scene is destroyed while photographs are read") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  Gate gate;
  auto walker = std::make_unique<Walker>(
      scene, GpuSceneOptions{.source = watched([&](std::size_t) { gate.pass(); }), .budgetBytes = kBudget},
      VkExtent2D{64, 64});
  walker->frame(walker->planAt({2, 0, 2}));
  const bool arrived = gate.waitForArrivals(2);
  std::thread opener([&] { gate.open(); });
  walker.reset();
  opener.join();
  CHECK(arrived);
}

TEST_CASE("a scene may be moved while photographs are read") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  HandExecutor hand;
  const GpuSceneOptions options{.source = Colours{}, .budgetBytes = kBudget, .executor = hand.executor()};
  Walker walker(scene, options, {64, 64});
  const FramePlan plan = walker.planAt({2, 0, 2});
  std::uint64_t number = 0;
  GpuScene::StreamStatus status;
  const auto stream = [&](GpuScene& by) {
    ++number;
    submitAndWait(testDevice(),
                  [&](VkCommandBuffer commands) { status = by.stream(commands, plan, number, number - 1); });
  };
  GpuScene first(testDevice(), scene, options);
  stream(first);
  CHECK(status.queued == 5);
  GpuScene second = std::move(first);
  hand.runAll();
  stream(second);
  CHECK(status.uploadedBytes > 0);
  GpuScene third(testDevice(), scene, options);
  third = std::move(second);
  do {
    stream(third);
    hand.runAll();
  } while (status.waiting > 0);
  CHECK(status.overBudget == 0);
}

TEST_CASE("streamAll needs no thread of the executor") {
  const Scene scene = gridScene(kSide, kPx, kPx);
  HandExecutor hand;
  Walker walker(scene, {.source = Colours{}, .budgetBytes = kBudget, .executor = hand.executor()}, {64, 64});
  const FramePlan plan = walker.planAt({2, 0, 2});
  streamAll(testDevice(), walker.gpuScene, plan, walker.number);
  CHECK(sharesOf(walker.frame(plan), 2 * kSide + 2).own > 0.99);
  CHECK(walker.streamed.waiting == 0);
}

TEST_CASE("the constructor reads several photographs at a time") {
  const Scene scene = gridScene(3, 64, 64);
  std::mutex mutex;
  std::condition_variable changed;
  int arrived = 0;
  bool together = false;
  const auto source = [&](const Scene& of, std::size_t node, int firstLevel) {
    std::unique_lock lock(mutex);
    ++arrived;
    changed.notify_all();
    together |= changed.wait_for(lock, std::chrono::minutes(2), [&] { return arrived >= 3; });
    return Colours{}(of, node, firstLevel);
  };
  const GpuScene opened(testDevice(), scene, {.source = source});
  CHECK(together);
}

TEST_CASE("opening a scene can be cancelled") {
  const Scene scene = gridScene(10, 64, 64);
  const std::uint32_t threads = GENERATE(0u, 2u);
  const int last = GENERATE(0, 20, 120);  // no read; while formats are found; while photographs are read
  std::stop_source stop;
  std::atomic<int> calls = 0;
  const auto source = [&](const Scene& of, std::size_t node, int firstLevel) {
    if (++calls >= last) stop.request_stop();
    return Colours{}(of, node, firstLevel);
  };
  if (last == 0) stop.request_stop();
  const GpuSceneOptions options{.source = source, .readerThreads = threads, .stop = stop.get_token()};
  CHECK(errorOf([&] { GpuScene(testDevice(), scene, options); }).code() == ErrorCode::cancelled);
  CHECK(calls <= last + int(threads) + 3);
}

TEST_CASE("what a source throws while a scene is opened reaches the caller") {
  const Scene scene = gridScene(4, 64, 64);
  const std::uint32_t threads = GENERATE(0u, 2u);
  const auto source = [&](const Scene& of, std::size_t node, int firstLevel) -> Texture {
    if (node == 7) throw std::runtime_error("7: gone");
    return Colours{}(of, node, firstLevel);
  };
  CHECK_THROWS_WITH(GpuScene(testDevice(), scene, {.source = source, .readerThreads = threads}), "7: gone");
}

TEST_CASE("too many reader threads are refused") {
  const Scene scene = gridScene(2, 64, 64);
  const GpuSceneOptions options{.source = Colours{}, .readerThreads = kMaxReaderThreads + 1};
  CHECK(errorOf([&] { GpuScene(testDevice(), scene, options); }).code() == ErrorCode::invalidInput);
}
