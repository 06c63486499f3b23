// SPDX-License-Identifier: Apache-2.0
// Planning over a previous plan allocates no heap memory after the first frames.
#include <catch2/catch.hpp>
#include <cstddef>

#include "ibr/frame_plan.h"
#include "support/allocation_count.h"
#include "support/plan_scenes.h"
#include "support/plan_walks.h"

using namespace ibr;

TEST_CASE("a walk over a plan allocates nothing, with every setting, in one and in two views") {
  const test::PlanSceneShape shape{8, 7, 6, 3, true};
  const Scene scene = test::makePlanScene(shape);
  const SceneBounds bounds = sceneBounds(scene, true);
  std::size_t faded = 0, switched = 0, gathered = 0, mapped = 0, aligned = 0;
  for (const RenderSettings& settings : test::planSettings())
    for (const bool stereo : {false, true}) {
      FrameInput input{{Camera{}}, settings, 1.0 / 60};
      if (stereo) input.views.resize(2);
      FramePlan plan;
      const auto walk = [&] {
        for (int frame = 0; frame < 400; ++frame) {
          for (std::size_t v = 0; v < input.views.size(); ++v) {
            input.views[v] = test::planWalk(shape, 2 * frame, 1280, 720);
            input.views[v].pose.position.x += 0.06 * double(v);
          }
          planFrame(scene, bounds, input, plan.next, plan);
          faded += plan.fadingOut.size();
          switched += plan.previous.size();
          gathered += plan.photographs.size();
          mapped += plan.next.colourSlots.size();
          aligned += !plan.cells.empty() && plan.cells[0].correction != Correction{};
        }
      };
      walk();
      plan.next = {};
      walk();  // a state without memory meets the memory of a walk
      walk();  // the walk's start follows its end
      const std::size_t before = test::allocationCount();
      walk();
      CHECK(test::allocationCount() - before == 0);
    }
  CHECK((faded > 0 && switched > 0 && gathered > 0 && mapped > 0 && aligned > 0));
}

TEST_CASE("a plan by value allocates") {
  const Scene scene = test::makePlanScene({2, 2, 1, 2});
  const SceneBounds bounds = sceneBounds(scene);
  const FrameInput input{{test::planCamera({0.5, 0, 0.5}, 0)}, {}, 0};
  static_cast<void>(planFrame(scene, bounds, input));
  const std::size_t before = test::allocationCount();
  static_cast<void>(planFrame(scene, bounds, input));
  CHECK(test::allocationCount() > before);
}
