// SPDX-License-Identifier: Apache-2.0
// Plans that are written over previous plans, and the working memory of planning.
#include <catch2/catch.hpp>
#include <limits>
#include <memory_resource>
#include <thread>
#include <vector>

#include "ibr/error.h"
#include "ibr/frame_plan.h"
#include "render/plan/frame_arena.h"
#include "support/error_of.h"
#include "support/plan_scenes.h"
#include "support/plan_walks.h"

using namespace ibr;

namespace {

const test::PlanSceneShape kShape{6, 5, 4, 2, true};

FrameInput inputAt(int frame, const RenderSettings& settings, bool stereo) {
  FrameInput input{{test::planWalk(kShape, 5 * frame, 640, 480)}, settings, 0.04};
  if (stereo) input.views.push_back(test::planWalk(kShape, 5 * frame + 1, 640, 480));
  return input;
}

}  // namespace

TEST_CASE("bounds that sceneBounds did not make, or of another scene, are refused") {
  const Scene scene = test::makePlanScene({3, 3, 1, 2});
  const FrameInput input{{test::planCamera({0.5, 0, 0.5}, 0)}, {}, 0};
  const SceneBounds other = sceneBounds(test::makePlanScene({2, 2, 1, 2})), unmade;
  CHECK(test::errorOf([&] { planFrame(scene, unmade, input); }).code() == ErrorCode::invalidInput);
  CHECK(test::errorOf([&] { planFrame(scene, other, input); }).code() == ErrorCode::invalidInput);
  CHECK(test::errorOf([&] { planFrame(Scene{}, {}, input); }).code() == ErrorCode::invalidInput);
  CHECK(planFrame(Scene{}, sceneBounds(Scene{}), input).cells.empty());
}

TEST_CASE("a plan over a previous plan is the plan of the same state, and may be the state's own") {
  const Scene scene = test::makePlanScene(kShape);
  const SceneBounds bounds = sceneBounds(scene);
  FramePlan reused;  // over all settings: nothing of another setting's plan stays
  for (const RenderSettings& settings : test::planSettings()) {
    FramePlan expected;
    reused.next = {};
    for (int frame = 0; frame < 60; ++frame) {
      const FrameInput input = inputAt(frame, settings, frame % 3 == 0);
      expected = planFrame(scene, bounds, input, expected.next);
      FramePlan other = planFrame(scene, bounds, inputAt(frame + 7, {}, false));
      planFrame(scene, bounds, input, reused.next, other);  // the state is another plan's
      REQUIRE(other == expected);
      planFrame(scene, bounds, input, reused.next, reused);
      REQUIRE(reused == expected);
    }
  }
}

TEST_CASE("a plan is unchanged if its input is refused") {
  const Scene scene = test::makePlanScene(kShape);
  const SceneBounds bounds = sceneBounds(scene);
  FramePlan plan = planFrame(scene, bounds, inputAt(3, {}, false));
  const FramePlan before = plan;
  REQUIRE(!before.cells.empty());
  FrameInput input = inputAt(4, {}, false);
  input.views[0].pose.position.x = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(planFrame(scene, bounds, input, plan.next, plan), Error);
  input = inputAt(4, {}, false);
  input.settings.renderScale = 0;
  CHECK_THROWS_AS(planFrame(scene, bounds, input, plan.next, plan), Error);
  input.settings = {};
  input.settings.composition = Composition::gathered;
  input.settings.gatherCandidates = 0;
  CHECK_THROWS_AS(planFrame(scene, bounds, input, plan.next, plan), Error);
  CHECK(plan == before);
}

TEST_CASE("a state of another scene, and plans of several scenes in turns, are planned as alone") {
  const Scene large = test::makePlanScene(kShape), small = test::makePlanScene({2, 2, 4, 2, true});
  const SceneBounds largeBounds = sceneBounds(large), smallBounds = sceneBounds(small);
  FramePlan plan, alone;
  for (int frame = 0; frame < 40; ++frame) {
    const bool isLarge = frame % 3 != 0;
    const Scene& scene = isLarge ? large : small;
    const SceneBounds& bounds = isLarge ? largeBounds : smallBounds;
    alone = planFrame(scene, bounds, inputAt(frame, {}, false), alone.next);
    planFrame(scene, bounds, inputAt(frame, {}, false), plan.next, plan);
    CHECK(plan == alone);
  }
}

TEST_CASE("threads plan at the same time") {
  const Scene scene = test::makePlanScene(kShape);
  const SceneBounds bounds = sceneBounds(scene);
  std::vector<FramePlan> plans(4);
  std::vector<std::thread> threads;
  for (FramePlan& plan : plans)
    threads.emplace_back([&] {
      RenderSettings settings;
      settings.alignCells = true;
      for (int frame = 0; frame < 60; ++frame)
        planFrame(scene, bounds, inputAt(frame, settings, true), plan.next, plan);
    });
  for (std::thread& thread : threads) thread.join();
  for (const FramePlan& plan : plans) CHECK(plan == plans[0]);
}

TEST_CASE("bounds with anchors give the plans of bounds that compute them later") {
  const Scene scene = test::makePlanScene(kShape);
  RenderSettings settings;
  settings.alignCells = true;
  const SceneBounds early = sceneBounds(scene, true), late = sceneBounds(scene);
  const FramePlan plan = planFrame(scene, early, inputAt(2, settings, true));
  CHECK(!plan.cells.empty());
  CHECK(plan == planFrame(scene, late, inputAt(2, settings, true)));
}

TEST_CASE("an arena gives aligned memory, and keeps one block for the next frame") {
  FrameArena arena;
  for (int frame = 0; frame < 3; ++frame) {
    arena.restart();
    std::vector<void*> blocks;
    for (const std::size_t size : {1u, 7u, 4096u, 3u, 1000000u, 5u})
      for (const std::size_t alignment : {1u, 8u, 64u}) {
        void* at = arena.allocate(size, alignment);
        CHECK(reinterpret_cast<std::uintptr_t>(at) % alignment == 0);
        std::fill_n(static_cast<std::byte*>(at), size, std::byte(blocks.size()));
        blocks.push_back(at);
      }
    for (std::size_t b = 0; b < blocks.size(); ++b) CHECK(*static_cast<std::byte*>(blocks[b]) == std::byte(b));
  }
  arena.restart();
  void* const first = arena.allocate(100, 8);
  arena.deallocate(first, 100, 8);
  CHECK(arena.allocate(50, 8) == first);  // the last allocation's memory is used again
  void* const second = arena.allocate(100, 8);
  static_cast<void>(arena.allocate(10, 8));
  arena.deallocate(second, 100, 8);  // not the last one
  CHECK(arena.allocate(100, 8) != second);
}
