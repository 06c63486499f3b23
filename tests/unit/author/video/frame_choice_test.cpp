// SPDX-License-Identifier: Apache-2.0
// Choice of frames from measures of videos with exact motion.
#include "author/video/frame_choice.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <set>

#include "author/video/frame_motion.h"

using namespace ibr;

namespace {

constexpr int kWidth = 960, kHeight = 540;
constexpr double kFps = 30;

struct View {
  glm::dvec3 position{0};
  double yaw = 0;  // radians
};

// Measures of a walk through a cloud of points that lie 2 to 20 m away on both sides; `focal` in parts of the width.
std::vector<FrameMeasure> measuresOf(const std::vector<View>& views, double focal = 0.85) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 6000; ++i)
    points.emplace_back(-15 + 60 * unit(random), -3 + 6 * unit(random), -(2 + 18 * unit(random)));
  std::vector<FrameMeasure> frames;
  for (const View& view : views) {
    FrameMeasure frame{{100, 100, 100, 100}, {}};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec3 p = glm::inverse(glm::angleAxis(view.yaw, glm::dvec3(0, 1, 0))) * (points[i] - view.position);
      if (p.z > -0.5) continue;
      const double x = kWidth * (0.5 + focal * p.x / -p.z), y = 0.5 * kHeight - kWidth * focal * p.y / -p.z;
      if (x > 0 && x < kWidth && y > 0 && y < kHeight) frame.points.push_back({std::uint32_t(i), float(x), float(y)});
    }
    frames.push_back(frame);
  }
  return frames;
}

MeasuredVideo videoOf(const std::vector<FrameMeasure>& frames) {
  return {frames, kWidth, kHeight, kFps};
}

std::vector<std::size_t> choose(const std::vector<FrameMeasure>& frames, std::size_t wanted = 0) {
  return chooseFrames(videoOf(frames), relativeSharpness(videoOf(frames)), wanted);
}

// A walk of a minute along x: slow, a stop, fast.
std::vector<View> walk(std::size_t frames = 1800) {
  std::vector<View> views;
  double x = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const double share = double(i) / double(frames);
    x += (share < 0.4 ? 0.3 : share < 0.6 ? 0.0 : 0.9) / kFps;
    views.push_back({{x, 0, 0}, 0.02 * std::sin(0.4 * double(i))});
  }
  return views;
}

}  // namespace

TEST_CASE("rotation has no parallax, and movement has") {
  const std::vector<FrameMeasure> frames = measuresOf({{}, {{0, 0, 0}, 0.1}, {{0.3, 0, 0}, 0}, {{0.3, 0, 0}, 0.1}});
  const auto motion = [&](int to) {
    return motionBetween(frames[0].points, frames[std::size_t(to)].points, kWidth, kHeight);
  };
  CHECK(motion(1).parallax < 1e-4);
  CHECK(motion(1).shift == Approx(0.85 * std::tan(0.1)).epsilon(0.2));
  CHECK(motion(2).parallax > 0.003);
  CHECK(motion(3).parallax == Approx(motion(2).parallax).epsilon(0.2));
  CHECK(motion(0).shift == 0);
  CHECK(motion(0).shared == 1);
  CHECK(motionBetween({}, frames[0].points, kWidth, kHeight).shared == 0);
}

TEST_CASE("another focal length leaves little parallax to a rotation") {
  for (const double focal : {0.6, 1.3}) {
    const std::vector<FrameMeasure> frames = measuresOf({{}, {{0, 0, 0}, 0.15}}, focal);
    CHECK(motionBetween(frames[0].points, frames[1].points, kWidth, kHeight).parallax < 0.01);
  }
}

TEST_CASE("a minute gives 40 to 80 frames, by motion and not by time") {
  const std::vector<View> views = walk();
  const std::vector<std::size_t> chosen = choose(measuresOf(views));
  CHECK((chosen.size() >= 40 && chosen.size() <= 80));
  CHECK(std::ranges::is_sorted(chosen));
  const auto within = [&](double from, double to) {
    return std::ranges::count_if(chosen,
                                 [&](std::size_t i) { return double(i) >= from * 1800 && double(i) < to * 1800; });
  };
  CHECK(within(0.42, 0.58) <= 1);                // the stop
  CHECK(within(0.6, 1.0) > 2 * within(0, 0.4));  // three times as fast
  // Even steps along the way.
  double least = 1e9, most = 0;
  for (std::size_t i = 1; i < chosen.size(); ++i) {
    const double step = views[chosen[i]].position.x - views[chosen[i - 1]].position.x;
    least = std::min(least, step);
    most = std::max(most, step);
  }
  CHECK(most < 3 * least);
}

TEST_CASE("a stated number of frames is met about") {
  const std::vector<FrameMeasure> frames = measuresOf(walk());
  for (const std::size_t wanted : {12u, 30u, 150u}) {
    const double count = double(choose(frames, wanted).size());
    INFO(wanted << " wanted, " << count << " chosen");
    CHECK((count >= 0.8 * double(wanted) && count <= 1.25 * double(wanted)));
  }
}

TEST_CASE("blurred frames are never chosen where sharp ones show the way") {
  std::mt19937 random(3);
  for (int round = 0; round < 5; ++round) {
    std::vector<FrameMeasure> frames = measuresOf(walk());
    std::set<std::size_t> blurred;
    while (blurred.size() < 500) {
      const std::size_t first = random() % frames.size(), length = 1 + random() % 6;
      for (std::size_t i = first; i < std::min(frames.size(), first + length); ++i) blurred.insert(i);
    }
    // A blur along one direction leaves the detail across it.
    for (const std::size_t i : blurred) frames[i].detail[random() % 4] *= 0.3f;
    for (const std::size_t i : choose(frames)) CHECK_FALSE(blurred.contains(i));
  }
}

TEST_CASE("sharpness is relative to the frames around") {
  std::vector<FrameMeasure> frames(200, FrameMeasure{{100, 100, 100, 100}, {}});
  for (std::size_t i = 100; i < 200; ++i) frames[i].detail = {4, 4, 4, 4};  // a plain wall
  frames[50].detail[1] = 25;
  const std::vector<double> sharpness = relativeSharpness(videoOf(frames));
  CHECK(sharpness[10] == 1);
  CHECK(sharpness[50] == Approx(0.5));
  CHECK(sharpness[180] == 1);
}

TEST_CASE("a turn on the spot, a cut, a still video and a short one are answered") {
  std::vector<View> turn;
  for (int i = 0; i < 300; ++i) turn.push_back({{0, 0, 0}, 0.01 * i});
  CHECK(choose(measuresOf(turn)).size() >= 5);
  // Points are lost at a cut: the next scene is used, too.
  std::vector<FrameMeasure> cut = measuresOf(walk(150));
  for (FrameMeasure frame : measuresOf(walk(150))) {
    for (TrackedPoint& point : frame.points) point.id += 100000;
    cut.push_back(frame);
  }
  const std::vector<std::size_t> chosen = choose(cut);
  CHECK(std::ranges::any_of(chosen, [](std::size_t i) { return i < 150; }));
  CHECK(std::ranges::any_of(chosen, [](std::size_t i) { return i >= 150; }));
  CHECK(choose(measuresOf(std::vector<View>(200))).size() == 1);
  CHECK(choose(measuresOf(std::vector<View>(1))).size() == 1);
  CHECK(choose({}).empty());
  // No points at all: a frame for each half second.
  const std::vector<FrameMeasure> dark(90);
  CHECK(choose(dark).size() <= 8);
}
