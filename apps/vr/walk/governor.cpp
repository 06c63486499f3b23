// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/governor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace ibr::app {
namespace {

constexpr std::size_t kMinRecent = 3;  // min. number of recent frames that decide
constexpr int kInFlight = 3;           // frames begun before a step takes effect
constexpr int kIgnoredFrames = 5;      // and the late frame after a pause
constexpr double kStepDownShare = 0.85, kFitShare = 0.78,
                 kDoubleStepShare = 1.25;  // of the period: step down, predicted to fit, two steps down
constexpr double kMissShare = 0.6;         // of the period: a second frame above it confirms a missed one
constexpr double kMissedShare = 0.5;  // of the period: a missed frame that took less was not missed because of its work
constexpr double kHeadroomSeconds = 1.5;  // for which the better level must be predicted to fit
constexpr double kAssumedRatio = 1.3;     // of steps that were not measured: steps up begin below 0.6 of the period
constexpr double kMaxRatio = 2.5;         // of one step; a higher one was measured while the load fell
constexpr double kMemorySeconds = 60;     // for which a ratio above the assumed one prevents a step up
constexpr double kReversalSeconds = 10;   // a step up that is reversed within this time counts as a mistake
constexpr int kMaxDoublings = 2;          // max. doublings of kMemorySeconds

bool isPositive(double value) {
  return std::isfinite(value) && value > 0;
}

// Returns the second highest of the recent costs: a single outlier must not decide.
double highest(const GovernorState& state) {
  if (state.recentCount < 2) return 0;
  auto costs = state.recent;
  std::nth_element(costs.begin(), costs.begin() + 1, costs.begin() + std::ptrdiff_t(state.recentCount),
                   std::greater<>());
  return costs[1];
}

// Ratio of the cost of this level to the cost of the next cheaper one.
double ratioOf(const GovernorState& state, std::size_t level) {
  const auto [ratio, measuredAt] = state.ratios[level];
  if (ratio <= 0) return kAssumedRatio;
  const double memory = kMemorySeconds * double(1 << state.reversals[level]);
  return state.seconds - measuredAt < memory ? ratio : std::min(ratio, kAssumedRatio);
}

// Measures the ratios of the last step's levels from the cost of the present level. A step of two levels gives both the
// same ratio. A better level that seems cheaper is no measurement, since the load has changed.
void measureStep(GovernorState& state, double costMs) {
  if (!state.lastStep || std::exchange(state.lastStepMeasured, true)) return;
  const auto [from, before] = *state.lastStep;
  const bool up = from > state.level;
  const std::size_t better = std::min(from, state.level), cheaper = std::max(from, state.level);
  const double ratio = std::pow(up ? costMs / before : before / costMs, 1 / double(cheaper - better));
  if (!std::isfinite(ratio) || ratio < 1) return;
  for (std::size_t i = better; i < cheaper; ++i) state.ratios[i] = {std::min(ratio, kMaxRatio), state.seconds};
}

// Returns true if the last step went up and is a mistake when it is reversed.
bool isFreshStepUp(const GovernorState& state) {
  return state.lastStep && state.lastStep->from > state.level && state.levelSeconds < kReversalSeconds;
}

// Measurement behind a decision.
struct Reason {
  double workMs;  // 0: unknown
  bool missed;
  double predictedMs = 0;  // of the better level; 0: not a step up
};

std::string line(const GovernorState& state, const Reason& why, const std::string& what) {
  std::string work = "missed";
  if (why.workMs > 0) {
    work = fmt::format("{:.1f} ms of {:.1f} ms{}", why.workMs, state.periodMs, why.missed ? ", missed" : "");
    if (why.predictedMs > 0) work += fmt::format(", {:.1f} ms predicted", why.predictedMs);
  }
  return fmt::format("frame {}: {}: {}", state.frame, work, what);
}

Decision stepTo(GovernorState& state, std::size_t level, double costMs, const Reason& why) {
  Decision decision{level, line(state, why, levelChange(state.levels[state.level], state.levels[level]))};
  state.lastStep = {state.level, costMs};
  state.lastStepMeasured = false;
  state.level = level;
  state.recentCount = 0;
  state.ignored = kInFlight;
  state.headroomSeconds = state.levelSeconds = 0;
  return decision;
}

Decision stepDown(GovernorState& state, double costMs, const Reason& why, std::size_t steps) {
  state.headroomSeconds = 0;
  measureStep(state, costMs);
  if (state.level + 1 == state.levels.size()) {
    if (std::exchange(state.lowestLevelReported, true)) return {state.level, ""};
    return {state.level, line(state, why, "the lowest level of detail is reached")};
  }
  const bool reverses = isFreshStepUp(state);
  int& reversals = state.reversals[state.level];
  reversals = reverses ? std::min(reversals + 1, kMaxDoublings) : 0;
  if (reverses) steps = 1;  // the level below has held
  return stepTo(state, std::min(state.level + steps, state.levels.size() - 1), costMs, why);
}

Decision stepUp(GovernorState& state, double costMs) {
  state.lowestLevelReported = false;
  return stepTo(state, state.level - 1, costMs, {costMs, false, predictedMs(state)});
}

void remember(GovernorState& state, double ms) {
  if (state.recentCount == GovernorState::kMaxRecent)
    std::shift_left(state.recent.begin(), state.recent.end(), 1);
  else
    ++state.recentCount;
  state.recent[state.recentCount - 1] = ms;
}

}  // namespace

GovernorState startGovernor(std::vector<RenderSettings> ladder) {
  GovernorState state;
  state.levels = std::move(ladder);
  state.ratios.assign(state.levels.size(), {});
  state.reversals.assign(state.levels.size(), 0);
  return state;
}

void changeLadder(GovernorState& state, std::vector<RenderSettings> ladder) {
  GovernorState fresh = startGovernor(std::move(ladder));
  fresh.level = std::min(state.level, fresh.levels.size() - 1);
  fresh.frame = state.frame;
  fresh.seconds = state.seconds;
  fresh.periodMs = state.periodMs;
  fresh.ignored = kInFlight;
  state = std::move(fresh);
}

void ignoreNextFrames(GovernorState& state) {
  state.ignored = std::max(state.ignored, kIgnoredFrames);
  state.lastStep.reset();  // the load may differ after the pause
}

double predictedMs(const GovernorState& state) {
  return state.level == 0 ? 0 : highest(state) * ratioOf(state, state.level - 1);
}

Decision govern(GovernorState& state, const FrameCost& cost) {
  ++state.frame;
  if (isPositive(cost.periodMs)) state.periodMs = cost.periodMs;
  const double period = state.periodMs;
  const Decision same{state.level, ""};
  if (!(period > 0)) return same;
  state.seconds += period / 1000;
  state.levelSeconds += period / 1000;
  if (state.ignored > 0) {
    --state.ignored;
    return same;
  }
  const bool known = isPositive(cost.workMs);
  // The frame after one that took too long is late because of that frame.
  const bool late = cost.missed && !(state.recentCount > 0 && state.recent[state.recentCount - 1] > period);
  const bool missed = known ? cost.workMs > period || (late && cost.workMs > kMissedShare * period) : late;
  if (!known && !missed) return same;
  remember(state, missed ? std::max(known ? cost.workMs : 0, period) : cost.workMs);
  const double high = highest(state);
  if ((missed && high > kMissShare * period) || (state.recentCount >= kMinRecent && high > kStepDownShare * period))
    return stepDown(state, high, {missed ? (known ? cost.workMs : 0) : high, missed},
                    high > kDoubleStepShare * period ? 2 : 1);
  const bool full = state.recentCount == GovernorState::kMaxRecent;
  if (full) measureStep(state, high);
  if (state.level == 0) return same;
  const bool fits = predictedMs(state) < kFitShare * period;
  state.headroomSeconds = fits ? state.headroomSeconds + period / 1000 : 0;
  return full && state.headroomSeconds >= kHeadroomSeconds ? stepUp(state, high) : same;
}

}  // namespace ibr::app
