// SPDX-License-Identifier: Apache-2.0
#include "render/plan/colour_plan.h"

#include <algorithm>
#include <cmath>

namespace ibr {
namespace {

constexpr std::int64_t kNoOwner = -1;

// A cell that was drawn in the previous frame keeps its slot; other slots are free. Only the plan's current cells get
// new tables. A cell that fades out, or of the previous draw order, uses the table that it had, or the identity.
void assignSlots(const PlanState& state, FramePlan& plan, std::pmr::memory_resource* memory) {
  std::vector<std::int64_t>& slots = plan.next.colourSlots;
  slots.assign(kColourSlotCount, kNoOwner);
  std::pmr::vector<PlannedCell*> drawn(memory);
  for (PlannedCell& cell : plan.cells) drawn.push_back(&cell);
  for (FadingOutCell& cell : plan.fadingOut) drawn.push_back(&cell.planned);
  for (PlannedCell& cell : plan.previous) drawn.push_back(&cell);
  const auto slotOf = [](const std::vector<std::int64_t>& all, const PlannedCell& cell) {
    return std::size_t(std::find(all.begin(), all.end(), std::int64_t(cell.cell)) - all.begin());
  };
  for (const PlannedCell* cell : drawn)
    if (const std::size_t slot = slotOf(state.colourSlots, *cell); slot < state.colourSlots.size())
      slots[slot] = cell->cell;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    PlannedCell* const cell = drawn[i];
    std::size_t slot = slotOf(slots, *cell);
    cell->colourTableIsNew = slotOf(state.colourSlots, *cell) == state.colourSlots.size();
    if (slot == slots.size() && i >= plan.cells.size()) {
      cell->colourSlot = kColourSlotCount;
      continue;
    }
    if (slot == slots.size()) slot = std::size_t(std::find(slots.begin(), slots.end(), kNoOwner) - slots.begin());
    slots[slot] = cell->cell;
    cell->colourSlot = std::uint32_t(slot);
  }
}

// A hidden cell's table is not measured: the remembered table stays; without one the cell is fresh when it appears.
void markNeeded(FramePlan& plan) {
  for (PlannedCell& cell : plan.cells) {
    cell.colourTableNeeded = !cell.hidden || plan.previousWeight > 0 || !plan.fadingOut.empty();
    if (!cell.colourTableNeeded && cell.colourTableIsNew) plan.next.colourSlots[cell.colourSlot] = kNoOwner;
  }
}

}  // namespace

void planColours(double seconds, const PlanState& state, FramePlan& plan, std::pmr::memory_resource* memory) {
  const RenderSettings& settings = plan.settings;
  ColourPlan& colour = plan.colour;
  if (settings.colourMapping == ColourMapping::off) return;
  const bool ours = settings.colourMapping == ColourMapping::ours;
  if (!ours) {  // the paper's sequence has one draw order in one image
    plan.previous.clear();
    plan.fadingOut.clear();
    plan.previousWeight = 0;
  }
  assignSlots(state, plan, memory);
  markNeeded(plan);
  const bool switched = state.mainCell >= 0 && plan.next.mainCell != state.mainCell;
  const double left = switched ? settings.colourFadeSeconds : state.colourFadeSecondsLeft;
  constexpr double kDone = 1e-9;  // tolerance for the rounding of a sum of many steps, seconds
  colour.mainShare = left > seconds + kDone ? seconds / left : 1.0;
  colour.mainTableFading = colour.mainShare < 1.0;
  plan.next.colourFadeSecondsLeft = colour.mainTableFading ? left - seconds : 0.0;
  if (ours) {
    const bool anyNew = std::any_of(plan.cells.begin(), plan.cells.end(),
                                    [](const auto& cell) { return cell.colourTableIsNew && cell.colourTableNeeded; });
    colour.countHistograms = anyNew || !eyesShare(plan) || state.framesSinceColourCount + 1 >= settings.colourPeriod;
    plan.next.framesSinceColourCount = colour.countHistograms ? 0 : state.framesSinceColourCount + 1;
    colour.share = settings.colourSmoothSeconds > 0 ? -std::expm1(-seconds / settings.colourSmoothSeconds) : 1.0;
    const double step = settings.colourMaxSpeed * seconds;
    colour.maxStep = step > 0 ? std::min(step, 255.0) : 0.0;  // NaN: 0
  }
}

}  // namespace ibr
