// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/governor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace ibr::app {
namespace {

constexpr std::size_t kRecent = 8, kMinRecent = 3;  // number of recent frames that decide
constexpr int kInFlight = 3;                        // frames begun before a step takes effect
constexpr int kIgnoredFrames = 5;                   // and the late frame after a pause
constexpr double kStepDownShare = 0.85, kHeadroomShare = 0.6,
                 kDoubleStepShare = 1.25;  // of the period: step down, step up, two steps down
constexpr double kMissedShare = 0.5;  // of the period: a missed frame that took less was not missed because of its work
constexpr double kHeadroomSeconds = 1.5;  // of room before a step up, at first
constexpr double kReversalSeconds = 10;   // a step up that is reversed within this time counts as a mistake
constexpr int kMaxDoublings = 6;          // max. doublings of kHeadroomSeconds
constexpr double kLoadDropShare = 0.8;    // of the cost at which a step up was reversed: below, the wait is reset

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
  return kHeadroomSeconds * double(1 << state.reversals[level]);
}

// Records that the step up to this level is reversed. If reversed soon, the next attempt waits twice as long.
void recordReversal(GovernorState& state) {
  int& reversals = state.reversals[state.level];
  const bool soon = state.levelSeconds < kReversalSeconds * double(1 << reversals);
  reversals = soon ? std::min(reversals + 1, kMaxDoublings) : 0;
  state.reversedCostMs[state.level] = state.costBeforeStepUpMs;
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
  state.lastStepWasUp = level < state.level;
  state.level = level;
  state.recent.clear();
  state.ignored = kInFlight;
  state.headroomSeconds = state.levelSeconds = 0;
  return decision;
}

Decision stepDown(GovernorState& state, const Reason& why, std::size_t steps) {
  state.headroomSeconds = 0;
  if (state.level + 1 == state.levels.size()) {
    if (std::exchange(state.lowestLevelReported, true)) return {state.level, ""};
    return {state.level, line(state, why, "the lowest level of detail is reached")};
  }
  if (state.lastStepWasUp) recordReversal(state);
  return stepTo(state, std::min(state.level + steps, state.levels.size() - 1), why);
}

Decision stepUp(GovernorState& state, double costMs) {
  state.costBeforeStepUpMs = costMs;
  state.lowestLevelReported = false;
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
  state.reversals.assign(state.levels.size(), 0);
  state.reversedCostMs.assign(state.levels.size(), 0);
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

void ignoreNextFrames(GovernorState& state) {
  state.ignored = std::max(state.ignored, kIgnoredFrames);
}

Decision govern(GovernorState& state, const FrameCost& cost) {
  ++state.frame;
  if (isPositive(cost.periodMs)) state.periodMs = cost.periodMs;
  const double period = state.periodMs;
  const Decision same{state.level, ""};
  if (!(period > 0)) return same;
  state.levelSeconds += period / 1000;
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
  if ((missed && high > kHeadroomShare * period) ||
      (state.recent.size() >= kMinRecent && high > kStepDownShare * period))
    return stepDown(state, {missed ? (known ? cost.workMs : 0) : high, missed},
                    high > kDoubleStepShare * period ? 2 : 1);
  state.headroomSeconds = high < kHeadroomShare * period ? state.headroomSeconds + period / 1000 : 0;
  if (state.level == 0 || state.recent.size() < kRecent) return same;
  const std::size_t above = state.level - 1;
  if (state.reversals[above] > 0 && high < kLoadDropShare * state.reversedCostMs[above]) state.reversals[above] = 0;
  return state.headroomSeconds >= waitAt(state, above) ? stepUp(state, high) : same;
}

}  // namespace ibr::app
