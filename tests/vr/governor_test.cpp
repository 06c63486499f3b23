// SPDX-License-Identifier: Apache-2.0
// The governor on simulated devices: a model gives the cost of frames at each level, a seeded generator the noise.
#include "vr/walk/governor.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <random>

using namespace ibr;
using namespace ibr::app;
using Catch::Contains;

namespace {

constexpr double kPeriod90 = 1000.0 / 90;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

Run run(GovernorState& state, const Simulated& device, int frames) {
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

std::vector<double> geometric(std::size_t count, double ratio) {
  std::vector<double> share(count);
  for (std::size_t i = 0; i < count; ++i) share[i] = std::pow(ratio, double(i));
  return share;
}

GovernorState fresh() {
  return startGovernor(ladder({}));
}

Simulated steady(double load, double ratio = 0.85, double noise = 0.03) {
  return {geometric(fresh().levels.size(), ratio), [load](int) { return load; }, noise};
}

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
  const Simulated dear{std::vector<double>(state.levels.size(), 0.55), [](int) { return kPeriod90; }};
  Simulated device = dear;
  device.share[0] = 1.1;
  run(state, device, 500);
  REQUIRE(state.level == 1);
  REQUIRE(state.ratios[0].ratio == Approx(2));
  // With a new ladder, nothing is known of the costs.
  GovernorState other = state;
  changeLadder(other, ladder({}));
  CHECK(other.level == 1);
  CHECK(std::ranges::all_of(other.ratios, [](const StepRatio& r) { return r.ratio == 0; }));
  const Run changed = run(other, dear, 200);
  CHECK(other.level == 0);
  CHECK(changed.changes == 1);
  // In the same scene the view changes: the ratio is forgotten after a minute, and the new one is learned.
  run(state, dear, 4500);
  CHECK(state.level == 1);
  run(state, dear, 1200);
  CHECK(state.level == 0);
  CHECK(state.ratios[0].ratio == Approx(1));
  CHECK(run(state, dear, 20000).changes == 0);
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
