// SPDX-License-Identifier: Apache-2.0
// Slots of the cells' colour tables and the speed of the tables, planned without a device.
#include "render/plan/colour_plan.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

using namespace ibr;

namespace {

FramePlan planOf(std::vector<std::uint32_t> cells, ColourMapping mapping = ColourMapping::ours) {
  FramePlan plan;
  plan.settings.colourMapping = mapping;
  for (std::uint32_t c : cells) plan.cells.emplace_back().cell = c;
  if (!cells.empty()) plan.next.mainCell = cells[0];
  return plan;
}

FramePlan colours(FramePlan plan, double seconds, const PlanState& state) {
  planColours(seconds, state, plan);
  return plan;
}

}  // namespace

TEST_CASE("a cell keeps its slot while it is drawn, and slots differ") {
  FramePlan plan = colours(planOf({7, 3, 9}), 0.02, {});
  for (const PlannedCell& cell : plan.cells) CHECK(cell.colourTableIsNew);
  const std::uint32_t slotOf3 = plan.cells[1].colourSlot, slotOf9 = plan.cells[2].colourSlot;
  plan = colours(planOf({3, 5, 9, 11}), 0.02, plan.next);
  CHECK(plan.cells[0].colourSlot == slotOf3);
  CHECK(plan.cells[2].colourSlot == slotOf9);
  CHECK_FALSE(plan.cells[0].colourTableIsNew);
  CHECK(plan.cells[1].colourTableIsNew);
  plan = colours(planOf({7}), 0.02, plan.next);
  CHECK(plan.cells[0].colourTableIsNew);  // absent for one frame
  plan = colours(planOf({7}, ColourMapping::off), 0.02, plan.next);
  CHECK(plan.cells[0].colourSlot == kColourSlotCount);
  CHECK(plan.next.colourSlots.empty());

  std::vector<std::uint32_t> many, others;
  for (std::uint32_t c = 0; c < kMaxCellCount; ++c) many.push_back(c), others.push_back(1000 + c);
  PlanState state = colours(planOf(many), 0, {}).next;
  for (int frame = 0; frame < 3; ++frame) {
    FramePlan full = planOf(frame % 2 ? many : others);
    for (std::uint32_t c : frame % 2 ? others : many) full.previous.emplace_back().cell = c;
    full = colours(full, 0, state);
    std::set<std::uint32_t> slots;
    for (const PlannedCell& cell : full.cells) slots.insert(cell.colourSlot);
    for (const PlannedCell& cell : full.previous) slots.insert(cell.colourSlot);
    CHECK(slots.size() == 2 * kMaxCellCount);
    CHECK(*slots.rbegin() < kColourSlotCount);
    state = full.next;
  }
}

TEST_CASE("cells of the previous order keep their tables and slots") {
  FramePlan plan = colours(planOf({1, 2}), 0.02, {});
  FramePlan next = planOf({2, 4});
  next.previous = planOf({1, 2}).cells;
  next.previousWeight = 1;
  next = colours(next, 0.02, plan.next);
  CHECK(next.previous[0].colourSlot == plan.cells[0].colourSlot);
  CHECK(next.previous[1].colourSlot == next.cells[0].colourSlot);
  CHECK_FALSE(next.previous[0].colourTableIsNew);
  CHECK(next.previousWeight == 1);

  next = planOf({2, 4}, ColourMapping::paper);
  next.previous = planOf({1, 2}).cells;
  next.previousWeight = 1;
  next = colours(next, 0.02, plan.next);
  CHECK(next.previous.empty());
  CHECK(next.previousWeight == 0);
}

TEST_CASE("cells without a table keep their colours") {
  FramePlan plan = planOf({1, 2});
  plan.previous = planOf({1, 5}).cells;
  plan.previousWeight = 1;
  plan.fadingOut = {{planOf({6}).cells[0], 1}, {plan.cells[1], 2}};
  plan = colours(plan, 0.02, {});  // colours were not mapped in the previous frame
  CHECK(plan.previous[1].colourSlot == kColourSlotCount);
  CHECK(plan.fadingOut[0].planned.colourSlot == kColourSlotCount);
  CHECK(plan.previous[0].colourSlot == plan.cells[0].colourSlot);
  CHECK(plan.fadingOut[1].planned.colourSlot == plan.cells[1].colourSlot);
}

TEST_CASE("the main table fades to the identity in equal steps, and restarts at a switch") {
  PlanState state = colours(planOf({1, 2}), 0, {}).next;
  state.mainCell = 1;
  FramePlan plan = planOf({2, 1});
  double left = 1;  // remaining part of the way
  int frames = 0;
  for (; left > 0 && frames < 100; ++frames) {
    plan = colours(planOf({2, 1}), 0.05, state);
    left *= 1 - plan.colour.mainShare;
    CHECK(left == Approx(std::max(0.0, 1 - 0.05 * (frames + 1))).margin(1e-9));
    state = plan.next;
    if (frames == 9) break;
  }
  CHECK(frames == 9);  // halfway
  plan = colours(planOf({1, 2}), 0.05, state);
  CHECK(plan.colour.mainShare == Approx(0.05));
  state = plan.next;
  for (frames = 1; plan.colour.mainShare < 1; ++frames) {
    plan = colours(planOf({1, 2}), 0.05, state);
    state = plan.next;
    REQUIRE(frames < 100);
  }
  CHECK(frames == 20);
  CHECK(state.colourFadeSecondsLeft == 0);
}

TEST_CASE("a time step of zero moves no table, and the first frame shows its target", "[N9][T18]") {
  FramePlan plan = colours(planOf({1, 2}), 0, {});
  CHECK(plan.colour.mainShare == 1);  // no previous table to fade from
  plan = colours(planOf({2, 1}), 0, plan.next);
  CHECK(plan.colour.mainShare == 0);
  CHECK(plan.colour.share == 0);
  CHECK(plan.colour.maxStep == 0);
  plan = colours(planOf({2, 1}), 0.1, plan.next);
  CHECK(plan.colour.share > 0.3);
  CHECK(plan.colour.share < 1);
  CHECK(plan.colour.maxStep == Approx(12));

  FramePlan atOnce = planOf({1, 2});
  atOnce.settings.colourSmoothSeconds = atOnce.settings.colourFadeSeconds = 0;
  atOnce = colours(atOnce, 0.02, plan.next);
  CHECK(atOnce.colour.share == 1);
  CHECK(atOnce.colour.mainShare == 1);

  plan = colours(planOf({1, 2}, ColourMapping::paper), 0.02, plan.next);  // paper fades without smoothing
  CHECK(plan.colour.share == 1);
  CHECK(plan.colour.maxStep == 255);
  CHECK(plan.colour.mainShare == Approx(0.02));
}

TEST_CASE("colours are counted every few frames, and at once for a new cell") {
  PlanState state;
  int counted = 0;
  for (int frame = 0; frame < 33; ++frame) {
    const FramePlan plan = colours(planOf({1, 2}), 0.02, state);
    CHECK(plan.colour.countHistograms == (frame % 8 == 0));
    counted += plan.colour.countHistograms;
    state = plan.next;
  }
  CHECK(counted == 5);
  CHECK_FALSE(colours(planOf({2, 1}), 0.02, state).colour.countHistograms);  // the same cells in another order
  CHECK(colours(planOf({1, 2, 3}), 0.02, state).colour.countHistograms);
  FramePlan always = planOf({1, 2});
  always.settings.colourPeriod = 1;
  CHECK(colours(always, 0.02, state).colour.countHistograms);
  CHECK(colours(planOf({1, 2}, ColourMapping::paper), 0.02, state).colour.countHistograms);
}

TEST_CASE("the main cell is drawn without a table once its table is the identity") {
  PlanState state;
  state.mainCell = 5;
  FramePlan plan = colours(planOf({1, 2}), 0.1, state);
  CHECK(plan.colour.mainTableFading);
  for (int frame = 0; frame < 8; ++frame) {
    plan.next.mainCell = 1;
    plan = colours(planOf({1, 2}), 0.1, plan.next);
    CHECK(plan.colour.mainTableFading);
  }
  plan = colours(planOf({1, 2}), 0.1, plan.next);
  CHECK(plan.colour.mainShare == 1);
  CHECK_FALSE(plan.colour.mainTableFading);
}
