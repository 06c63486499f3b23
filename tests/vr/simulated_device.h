// SPDX-License-Identifier: Apache-2.0
// The governor on simulated devices: a model gives the cost of frames at each level, a seeded generator the noise.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "vr/walk/governor.h"

namespace ibr::app {

inline constexpr double kPeriod90 = 1000.0 / 90;

// A device whose frames take `load` (ms at level 0, by frame) times the level's share.
struct Simulated {
  std::vector<double> share;  // share of level 0's time, by level
  std::function<double(int)> load;
  double noise = 0;  // of a frame's time: maximum relative deviation
  double periodMs = kPeriod90;
  int inFlight = 2;  // frames from a decision to the first frame that shows its effect
};

struct Run {
  int changes = 0, missed = 0, lastChange = 0;
  std::vector<std::size_t> levels;  // level decided in each frame
  std::vector<std::string> lines;
};

inline Run run(GovernorState& state, const Simulated& device, int frames) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::deque<std::size_t> coming(std::size_t(device.inFlight), state.level);
  Run run;
  for (int frame = 0; frame < frames; ++frame) {
    coming.push_back(state.level);
    const double ms = device.load(frame) * device.share.at(coming.front()) * (1 + device.noise * any(random));
    coming.pop_front();
    const bool missed = ms > device.periodMs;
    const std::size_t before = state.level;
    const Decision decision = govern(state, {ms, device.periodMs, missed});
    REQUIRE(decision.level == state.level);
    REQUIRE(state.level < state.levels.size());
    run.missed += missed;
    if (decision.level != before) {
      ++run.changes;
      run.lastChange = frame;
      REQUIRE(!decision.reason.empty());
    }
    run.levels.push_back(decision.level);
    if (!decision.reason.empty()) run.lines.push_back(decision.reason);
  }
  return run;
}

inline std::vector<double> geometric(std::size_t count, double ratio) {
  std::vector<double> share(count);
  for (std::size_t i = 0; i < count; ++i) share[i] = std::pow(ratio, double(i));
  return share;
}

inline GovernorState fresh() {
  return startGovernor(ladder({}));
}

inline Simulated steady(double load, double ratio = 0.85, double noise = 0.03) {
  return {geometric(fresh().levels.size(), ratio), [load](int) { return load; }, noise};
}

}  // namespace ibr::app
