// SPDX-License-Identifier: Apache-2.0
// Steps of the governor. Predictions: governor_prediction_test.cpp.
#include "vr/walk/governor.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "vr/simulated_device.h"

using namespace ibr;
using namespace ibr::app;
using Catch::Contains;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("governor: the level stays at any load below the limit") {
  for (const double share : {0.01, 0.3, 0.59, 0.61, 0.8}) {
    GovernorState state = fresh();
    CHECK(run(state, steady(share * kPeriod90), 3000).changes == 0);
  }
}

TEST_CASE("governor: settles under any constant load that a level can hold") {
  for (const double ratio : {0.6, 0.75, 0.85, 0.95})
    for (double load = 0.3; load < 3; load *= 1.07) {
      GovernorState state = fresh();
      const Simulated device = steady(load * kPeriod90, ratio);
      const Run settled = run(state, device, 10000);
      const double cost = load * device.share[state.level];
      CAPTURE(ratio, load, state.level, settled.changes, settled.missed);
      if (load * device.share.back() < 0.8) CHECK(cost <= 0.88);
      // The next better level would take more than 0.6 of the period.
      if (state.level > 0) CHECK(load * device.share[state.level - 1] > 0.6);
      CHECK(settled.changes <= 12);
      if (load * device.share.back() < 0.8) CHECK(settled.missed <= 30);
    }
}

TEST_CASE("governor: steps down before a frame is missed while a load grows") {
  for (const double noise : {0.0, 0.05})
    for (const double periodMs : {1000.0 / 72, kPeriod90, 1000.0 / 120}) {
      GovernorState state = fresh();
      Simulated device = steady(0, 0.85, noise);
      device.periodMs = periodMs;
      device.load = [&](int frame) { return periodMs * (0.4 + 1.2 * frame / 4000.0); };
      const Run ramp = run(state, device, 4000);
      CHECK(ramp.missed == 0);
      CHECK(state.level >= 3);
      CHECK(std::ranges::is_sorted(ramp.levels));
    }
}

TEST_CASE("governor: after a load step few frames are missed, and the level recovers afterwards") {
  for (const double leap : {1.1, 1.5, 2.0, 2.6}) {
    GovernorState state = fresh();
    Simulated device = steady(0);
    device.load = [&](int frame) { return kPeriod90 * (frame >= 500 && frame < 1500 ? leap * 0.95 : 0.5); };
    const Run leaped = run(state, device, 1500);
    CAPTURE(leap, leaped.missed, state.level);
    CHECK(leaped.levels[499] == 0);
    CHECK(leaped.missed <= 25);
    CHECK(leaped.missed >= 1);
    CHECK(leaped.lastChange < 560);
    // The governor raises quality by one level in about 1.5 s.
    device.load = [](int) { return 0.5 * kPeriod90; };
    const std::size_t deepest = state.level;
    const Run back = run(state, device, int(double(deepest + 1) * 1.7 * 90));
    CHECK(state.level == 0);
    CHECK(back.missed == 0);
    CHECK(back.changes == int(deepest));
  }
}

TEST_CASE("governor: a level held for long is tried again at once after a later step down") {
  GovernorState state = fresh();
  Simulated device = steady(0, 0.85, 0);
  for (int time = 0; time < 8; ++time) {
    device.load = [](int) { return 0.5 * kPeriod90; };
    run(state, device, 30 * 90);
    CHECK(state.level == 0);
    device.load = [](int) { return 0.95 * kPeriod90; };
    run(state, device, 90);
    CHECK(state.level > 0);
  }
  device.load = [](int) { return 0.4 * kPeriod90; };
  run(state, device, 200);
  CHECK(state.level == 0);
}

TEST_CASE("governor: one late frame changes nothing, two late frames do") {
  for (const double hitch : {15.0, 100.0, 2000.0}) {
    GovernorState state = fresh();
    Simulated device = steady(0, 0.85, 0.02);
    device.load = [&](int frame) { return frame % 40 == 7 ? hitch : 0.55 * kPeriod90; };
    CHECK(run(state, device, 4000).changes == 0);
  }
  // A slow outlier does not prevent higher quality.
  GovernorState state = fresh();
  state.level = 2;
  Simulated device = steady(0, 0.85, 0);
  device.load = [](int frame) { return frame % 40 == 7 ? 100 : 0.4 * kPeriod90; };
  run(state, device, 400);
  CHECK(state.level == 0);

  GovernorState twice = fresh();
  device.load = [](int frame) { return frame == 50 || frame == 53 ? 100 : 0.4 * kPeriod90; };
  const Run two = run(twice, device, 100);
  CHECK(two.levels[52] == 0);
  CHECK(two.levels[53] == 2);  // far over the budget
  CHECK(two.changes == 1);
}

TEST_CASE("governor: steps down at once after a missed frame, and near the limit without one") {
  GovernorState state = fresh();
  for (int i = 0; i < 20; ++i) CHECK(govern(state, {0.7 * kPeriod90, kPeriod90, false}).reason.empty());
  CHECK(govern(state, {1.05 * kPeriod90, kPeriod90, true}).level == 1);

  GovernorState near = fresh();
  int frames = 0;
  while (near.level == 0 && frames < 100) {
    govern(near, {0.9 * kPeriod90, kPeriod90, false});
    ++frames;
  }
  CHECK(frames == 3);
  // Frames begun before the change are ignored.
  for (int i = 0; i < 3; ++i) CHECK(govern(near, {3 * kPeriod90, kPeriod90, true}).level == 1);
  CHECK(govern(near, {0.5 * kPeriod90, kPeriod90, false}).level == 1);
}

TEST_CASE("governor: a decision gives a log line with frame, times and change") {
  GovernorState state = fresh();
  for (int i = 0; i < 809; ++i) govern(state, {6, 11.111, false});
  std::string line;
  for (int i = 0; i < 10 && line.empty(); ++i) line = govern(state, {10.4, 11.111, false}).reason;
  CHECK_THAT(line, Contains("811") && Contains("10.4 ms") && Contains("11.1 ms") && Contains("cells 12 → 8"));
  for (int i = 0; i < 200 && line[0] == 'f' && state.level == 1; ++i)
    line = govern(state, {3, 11.111, false}).reason + "f";
  CHECK_THAT(line, Contains("950") && Contains("3.0 ms of 11.1 ms, 7.5 ms predicted") && Contains("cells 8 → 12"));
}

TEST_CASE("governor: a load too high for the lowest level is reported once") {
  GovernorState state = fresh();
  const Run slow = run(state, steady(100 * kPeriod90, 0.9), 3000);
  CHECK(state.level + 1 == state.levels.size());
  REQUIRE(slow.lines.size() == std::size_t(slow.changes) + 1);
  CHECK(slow.lines.back().find("lowest level") != std::string::npos);
  GovernorState again = state;
  run(again, steady(0.1 * kPeriod90), 2000);
  CHECK(again.level == 0);
  CHECK(run(again, steady(100 * kPeriod90), 300).lines.back().find("lowest level") != std::string::npos);
  // A short drop in load is not the required 1.5 s.
  Simulated device = steady(0, 1, 0);
  device.load = [](int frame) { return frame % 100 < 60 ? 0.3 * kPeriod90 : 2 * kPeriod90; };
  CHECK(run(state, device, 3000).changes == 0);
}

TEST_CASE("governor: costs that are not positive and finite change nothing") {
  for (const double none : {0.0, -1.0, kNaN, kInfinity, -kInfinity}) {
    GovernorState state = fresh();
    for (int i = 0; i < 500; ++i) CHECK(govern(state, {none, kPeriod90, false}).reason.empty());
    CHECK(state.frame == 500);
  }
}

TEST_CASE("governor: decides nothing before the first period, and then uses the last valid one") {
  GovernorState state = fresh();
  for (int i = 0; i < 100; ++i) CHECK(govern(state, {50, kNaN, true}).level == 0);
  govern(state, {5, kPeriod90, false});
  for (int i = 0; i < 10; ++i) govern(state, {50, 0, true});
  CHECK(state.level > 0);
}

TEST_CASE("governor: missed frames count if the cost is unknown, and not if the cost is low") {
  GovernorState unknown = fresh();
  for (int i = 0; i < 10; ++i) govern(unknown, {kNaN, kPeriod90, true});
  CHECK(unknown.level > 0);
  GovernorState others = fresh();
  for (int i = 0; i < 1000; ++i) CHECK(govern(others, {0.3 * kPeriod90, kPeriod90, true}).level == 0);
  GovernorState ours = fresh();
  for (int i = 0; i < 10; ++i) govern(ours, {0.7 * kPeriod90, kPeriod90, true});
  CHECK(ours.level > 0);
}

TEST_CASE("governor: a new refresh rate changes the limit at once") {
  GovernorState state = fresh();
  for (int i = 0; i < 500; ++i) CHECK(govern(state, {8.5, 1000.0 / 90, false}).level == 0);
  for (int i = 0; i < 20; ++i) govern(state, {i < 4 ? 8.5 : 6, 1000.0 / 120, false});
  CHECK(state.level > 0);
  for (int i = 0; i < 500; ++i) govern(state, {6, 1000.0 / 72, false});
  CHECK(state.level == 0);
}

TEST_CASE("governor: a new ladder keeps the level, limited to its length") {
  GovernorState state = fresh();
  run(state, steady(100 * kPeriod90), 300);
  const std::size_t last = state.levels.size() - 1;
  REQUIRE(state.level == last);
  RenderSettings few;
  few.maxCells = 2;
  const auto shorter = ladder(few);
  REQUIRE(shorter.size() <= last);
  changeLadder(state, shorter);
  CHECK(state.level == shorter.size() - 1);
  CHECK(state.frame == 300);
  run(state, steady(0.1 * kPeriod90), 3000);
  CHECK(state.level == 0);
  CHECK((state.levels[0] == few));
  // A ladder of one level never changes.
  GovernorState one = startGovernor({RenderSettings{}});
  run(one, {{1.0}, [](int) { return 50.0; }}, 500);
  CHECK(one.level == 0);
}

TEST_CASE("governor: is deterministic") {
  GovernorState a = fresh(), b = fresh();
  const Simulated device = steady(1.3 * kPeriod90, 0.85, 0.2);
  CHECK((run(a, device, 5000).levels == run(b, device, 5000).levels));
}

TEST_CASE("governor: excused frames, and a late frame after a slow one, change nothing") {
  GovernorState excused = fresh();
  for (int i = 0; i < 20; ++i) govern(excused, {5.8, kPeriod90, false});
  GovernorState blamed = excused;
  ignoreNextFrames(excused);
  for (int i = 0; i < 3; ++i) {
    CHECK(govern(excused, {300, kPeriod90, true}).reason.empty());
    govern(blamed, {300, kPeriod90, true});
  }
  for (int i = 0; i < 50; ++i) CHECK(govern(excused, {5.8, kPeriod90, false}).reason.empty());
  CHECK(excused.level == 0);
  CHECK(blamed.level > 0);
  // The ignored frames have passed.
  for (int i = 0; i < 5; ++i) govern(excused, {300, kPeriod90, true});
  CHECK(excused.level > 0);

  GovernorState late = fresh();
  for (int i = 0; i < 20; ++i) govern(late, {5.8, kPeriod90, false});
  CHECK(govern(late, {300, kPeriod90, true}).reason.empty());
  CHECK(govern(late, {5.8, kPeriod90, true}).reason.empty());
  CHECK(late.level == 0);
}

TEST_CASE("governor: a log line contains the measured times and a missed frame") {
  GovernorState state = fresh();
  for (int i = 0; i < 20; ++i) govern(state, {7.8, 11.111, false});
  CHECK_THAT(govern(state, {7.9, 11.111, true}).reason,
             Contains("21") && Contains("7.9 ms") && Contains("missed") && Contains("cells 12 → 8"));
  GovernorState unknown = fresh();
  std::string line;
  for (int i = 0; i < 10 && line.empty(); ++i) line = govern(unknown, {kNaN, 11.111, true}).reason;
  CHECK_THAT(line, Contains("missed") && Contains("cells") && !Contains(" ms"));
}
