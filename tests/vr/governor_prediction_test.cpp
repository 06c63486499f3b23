// SPDX-License-Identifier: Apache-2.0
// Predicted steps up of the governor.
#include <algorithm>
#include <catch2/catch.hpp>

#include "vr/simulated_device.h"

using namespace ibr;
using namespace ibr::app;

TEST_CASE("governor: a load between two levels causes no oscillation") {
  const std::size_t count = fresh().levels.size();
  for (std::size_t fits = 1; fits < count; ++fits)
    for (const double noise : {0.0, 0.02, 0.1})
      for (const double over : {0.86, 0.95, 1.1, 1.6}) {
        GovernorState state = fresh();
        Simulated device{std::vector<double>(count, 0.55), [](int) { return kPeriod90; }, noise};
        for (std::size_t i = 0; i < fits; ++i) device.share[i] = over;
        // The better level is not tried for a minute, which is 5400 frames.
        const Run first = run(state, device, 5400);
        CAPTURE(fits, noise, over, first.changes, first.missed);
        CHECK(state.level >= fits);
        CHECK(first.changes <= int(fits) + 1);  // a double step may pass the level that fits, and returns to it
        CHECK(first.lastChange < 1000);
        CHECK(first.missed <= 5 * int(fits) + 5);  // frames in flight, then two misses
        // Then at most one attempt, since that doubles the minute.
        const Run later = run(state, device, 10000);
        CHECK(later.changes <= 4);
        if (over < 1.25) CHECK(std::ranges::count(later.levels, fits) > 9500);  // no double steps
      }
}

TEST_CASE("governor: a measured step up that fits above 60 % of the period is made") {
  // Each level saves 5 %: a level at 70 % of the period leaves room for the next better one.
  GovernorState state = fresh();
  Simulated device = steady(0.9 * kPeriod90, 0.95, 0);
  run(state, device, 500);
  const std::size_t lower = state.level;
  REQUIRE(lower > 0);
  device.load = [&](int) { return 0.7 * kPeriod90 / device.share[lower]; };
  run(state, device, 200);
  CHECK(state.level == lower - 1);
  // Without a measurement, the same cost is no reason for a step up.
  GovernorState unmeasured = fresh();
  unmeasured.level = lower;
  run(unmeasured, device, 2000);
  CHECK(unmeasured.level == lower);
}

TEST_CASE("governor: predicts the time of the next better level from the steps down") {
  for (const double ratio : {0.5, 0.7, 0.9}) {
    GovernorState state = fresh();
    const Simulated device = steady(0.95 * kPeriod90, ratio, 0);
    run(state, device, 100);
    CAPTURE(ratio, state.level);
    REQUIRE(state.level > 0);
    const double better = 0.95 * kPeriod90 * device.share[state.level - 1];
    CHECK(predictedMs(state) == Approx(better));
    // The ratio holds at any load.
    for (int i = 0; i < 8; ++i) govern(state, {0.3, kPeriod90, false});
    CHECK(predictedMs(state) == Approx(0.3 / ratio));
  }
  // A double step gives both levels the same ratio.
  GovernorState twice = fresh();
  Simulated device = steady(1.5 * kPeriod90, 0.6, 0);
  run(twice, device, 30);
  REQUIRE(twice.level == 2);
  CHECK(predictedMs(twice) == Approx(1.5 * 0.6 * kPeriod90));
  CHECK(twice.ratios[0].ratio == Approx(1 / 0.6));
}

TEST_CASE("governor: a level without measured ratio is assumed to cost 1.3 times as much") {
  GovernorState state = fresh();
  CHECK(predictedMs(state) == 0);
  state.level = 3;
  CHECK(predictedMs(state) == 0);  // no frames yet
  for (int i = 0; i < 8; ++i) govern(state, {5, kPeriod90, false});
  CHECK(predictedMs(state) == Approx(6.5));
  // The step up measures the ratio.
  Simulated device = steady(0, 0.8, 0);
  device.load = [&](int) { return 0.4 * kPeriod90 / device.share[3]; };
  run(state, device, 200);
  REQUIRE(state.level == 2);
  CHECK(state.ratios[2].ratio == Approx(1.25));
  CHECK(state.ratios[1].ratio == 0);
}

TEST_CASE("governor: a ratio that was measured while the load changed does not block recovery") {
  // The load falls together with the step down, so the step seems to save more than it does.
  GovernorState state = fresh();
  Simulated device = steady(0, 0.85, 0);
  device.load = [](int frame) { return (frame < 100 ? 0.6 : frame < 104 ? 1.2 : 0.5) * kPeriod90; };
  run(state, device, 150);
  const std::size_t lower = state.level;
  REQUIRE(lower > 0);
  CHECK(state.ratios[lower - 1].ratio > 1.5);
  run(state, steady(0.62 * kPeriod90, 0.85, 0), 5400 + 150 * int(lower));
  CHECK(state.level == 0);
  // The load grows together with the step down: the better level does not seem cheaper.
  GovernorState grown = fresh();
  device.load = [](int frame) { return (frame < 100 ? 0.6 : frame < 104 ? 0.9 : 1.1) * kPeriod90; };
  run(grown, device, 115);
  REQUIRE(grown.level == 2);
  CHECK(grown.ratios[0].ratio == 0);
}

TEST_CASE("governor: learns again after the scene changes") {
  GovernorState state = fresh();
  const Simulated cheap{std::vector<double>(state.levels.size(), 0.55), [](int) { return kPeriod90; }};
  Simulated device = cheap;
  device.share[0] = 1.1;
  run(state, device, 500);
  REQUIRE(state.level == 1);
  REQUIRE(state.ratios[0].ratio == Approx(2));
  // With a new ladder, nothing is known of the costs.
  GovernorState other = state;
  changeLadder(other, ladder({}));
  CHECK(other.level == 1);
  CHECK(std::ranges::all_of(other.ratios, [](const StepRatio& r) { return r.ratio == 0; }));
  const Run changed = run(other, cheap, 200);
  CHECK(other.level == 0);
  CHECK(changed.changes == 1);
  // In the same scene the view changes: the ratio is forgotten after a minute, and the new one is learned.
  run(state, cheap, 4500);
  CHECK(state.level == 1);
  run(state, cheap, 1200);
  CHECK(state.level == 0);
  CHECK(state.ratios[0].ratio == Approx(1));
  CHECK(run(state, cheap, 20000).changes == 0);
}

TEST_CASE("governor: attempts become rarer while they fail") {
  GovernorState state = fresh();
  Simulated device = steady(kPeriod90, 0.85, 0);
  device.share.assign(device.share.size(), 0.55);
  device.share[0] = 1.1;
  std::vector<int> attempts;  // frames of the steps up
  const Run failing = run(state, device, 20 * 60 * 90);
  for (std::size_t i = 1; i < failing.levels.size(); ++i)
    if (failing.levels[i] < failing.levels[i - 1]) attempts.push_back(int(i));
  REQUIRE(attempts.size() >= 3);
  CHECK(attempts.size() <= 6);
  CHECK(attempts[0] > 60 * 90);
  for (std::size_t i = 2; i < attempts.size(); ++i)
    CHECK(attempts[i] - attempts[i - 1] + 2 >= attempts[i - 1] - attempts[i - 2]);
  // A smaller load needs no attempt to be trusted.
  device.load = [](int) { return 0.6 * kPeriod90; };
  run(state, device, 150);
  CHECK(state.level == 0);
}
