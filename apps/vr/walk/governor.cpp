// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/governor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace ibr::app {
namespace {

constexpr std::size_t kRecent = 8, kLeastRecent = 3;          // number of recent frames that decide
constexpr int kInFlight = 3;                                  // frames begun before a step takes effect
constexpr int kExcused = 5;                                   // and the late frame after an excuse
constexpr double kFull = 0.85, kRoom = 0.6, kFarOver = 1.25;  // of the period: step down, step up, two steps down
constexpr double kMissedShare = 0.5;  // of the period: a missed frame that took less was not missed because of its work
constexpr double kRoomSeconds = 1.5;  // of room before a step up, at first
constexpr double kSoonSeconds = 10;   // a step up that is reversed within this time counts as a mistake
constexpr int kMostTaken = 6;         // max. doublings of kRoomSeconds
constexpr double kSmallerLoad = 0.8;  // of the cost at which a step up was reversed: below, the wait is reset

bool isPositive(double value) {
  return std::isfinite(value) && value > 0;
}

// Returns the second highest of the recent costs: a single outlier must not decide.
double highest(const GovernorState& state) {
  if (state.recent.size() < 2) return 0;
  std::vector<double> costs = state.recent;
  std::nth_element(costs.begin(), costs.begin() + 1, costs.end(), std::greater<>());
  return costs[1];
}

double waitAt(const GovernorState& state, std::size_t level) {
  return kRoomSeconds * double(1 << state.taken[level]);
}

// Records that the step up to this level is reversed. If reversed soon, the next attempt waits twice as long.
void noteTakenBack(GovernorState& state) {
  int& taken = state.taken[state.level];
  const bool soon = state.heldSeconds < kSoonSeconds * double(1 << taken);
  taken = soon ? std::min(taken + 1, kMostTaken) : 0;
  state.takenCostMs[state.level] = state.climbCostMs;
}

// Measurement behind a decision.
struct Reason {
  double workMs;  // 0: unknown
  bool missed;
};

std::string line(const GovernorState& state, const Reason& why, const std::string& what) {
  const std::string work =
      why.workMs > 0 ? fmt::format("{:.1f} ms of {:.1f} ms{}", why.workMs, state.periodMs, why.missed ? ", missed" : "")
                     : std::string("missed");
  return fmt::format("frame {}: {}: {}", state.frame, work, what);
}

Decision stepTo(GovernorState& state, std::size_t level, const Reason& why) {
  Decision decision{level, line(state, why, levelChange(state.levels[state.level], state.levels[level]))};
  state.climbed = level < state.level;
  state.level = level;
  state.recent.clear();
  state.ignored = kInFlight;
  state.roomSeconds = state.heldSeconds = 0;
  return decision;
}

Decision stepDown(GovernorState& state, const Reason& why, std::size_t steps) {
  state.roomSeconds = 0;
  if (state.level + 1 == state.levels.size()) {
    if (std::exchange(state.exhausted, true)) return {state.level, ""};
    return {state.level, line(state, why, "the lowest level of detail is reached")};
  }
  if (state.climbed) noteTakenBack(state);
  return stepTo(state, std::min(state.level + steps, state.levels.size() - 1), why);
}

Decision stepUp(GovernorState& state, double costMs) {
  state.climbCostMs = costMs;
  state.exhausted = false;
  return stepTo(state, state.level - 1, {costMs, false});
}

void remember(GovernorState& state, double ms) {
  if (state.recent.size() == kRecent) state.recent.erase(state.recent.begin());
  state.recent.push_back(ms);
}

}  // namespace

GovernorState startGovernor(std::vector<RenderSettings> ladder) {
  GovernorState state;
  state.levels = std::move(ladder);
  state.taken.assign(state.levels.size(), 0);
  state.takenCostMs.assign(state.levels.size(), 0);
  return state;
}

void changeLadder(GovernorState& state, std::vector<RenderSettings> ladder) {
  GovernorState fresh = startGovernor(std::move(ladder));
  fresh.level = std::min(state.level, fresh.levels.size() - 1);
  fresh.frame = state.frame;
  fresh.periodMs = state.periodMs;
  fresh.ignored = kInFlight;
  state = std::move(fresh);
}

void excuse(GovernorState& state) {
  state.ignored = std::max(state.ignored, kExcused);
}

Decision govern(GovernorState& state, const FrameCost& cost) {
  ++state.frame;
  if (isPositive(cost.periodMs)) state.periodMs = cost.periodMs;
  const double period = state.periodMs;
  const Decision same{state.level, ""};
  if (!(period > 0)) return same;
  state.heldSeconds += period / 1000;
  if (state.ignored > 0) {
    --state.ignored;
    return same;
  }
  const bool known = isPositive(cost.workMs);
  // The frame after one that took too long is late because of that frame.
  const bool late = cost.missed && !(state.recent.size() > 0 && state.recent.back() > period);
  const bool missed = known ? cost.workMs > period || (late && cost.workMs > kMissedShare * period) : late;
  if (!known && !missed) return same;
  remember(state, missed ? std::max(known ? cost.workMs : 0, period) : cost.workMs);
  const double high = highest(state);
  if ((missed && high > kRoom * period) || (state.recent.size() >= kLeastRecent && high > kFull * period))
    return stepDown(state, {missed ? (known ? cost.workMs : 0) : high, missed}, high > kFarOver * period ? 2 : 1);
  state.roomSeconds = high < kRoom * period ? state.roomSeconds + period / 1000 : 0;
  if (state.level == 0 || state.recent.size() < kRecent) return same;
  const std::size_t above = state.level - 1;
  if (state.taken[above] > 0 && high < kSmallerLoad * state.takenCostMs[above]) state.taken[above] = 0;
  return state.roomSeconds >= waitAt(state, above) ? stepUp(state, high) : same;
}

}  // namespace ibr::app
