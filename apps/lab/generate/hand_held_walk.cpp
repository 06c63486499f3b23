// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/hand_held_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/check.h"
#include "base/random.h"

namespace ibr {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kStep = 0.001;      // s, between entries of the tables
constexpr double kEyes = 1.55;       // m
constexpr double kStride = 0.7;      // m; 2 steps a second at 1.4 m/s
constexpr double kBounce = 0.022;    // m, of steps at kFullBounce m/s and above
constexpr double kFullBounce = 0.8;  // m/s
constexpr double kTurnSpeed = 0.95;  // radians/s, on the spot
constexpr double kChange = 0.25;     // share of a part that passes until its speed is reached
constexpr double kRateWave = 0.45;   // radians a frame, of varying frame times
constexpr double kRateShift = 0.56;  // of the time between frames; with kRateWave, times between frames vary by 25 %
constexpr double kPulse = 0.16;      // width of a jolt, of the time between frames: neighbouring frames stay sharp
constexpr double kLeastSmear = 0.022, kMostSmear = 0.038;  // of the image's width: 14 to 24 px of 640
constexpr double kJoltedShare = 0.28;
constexpr int kPlans = 200;  // of jolted frames, of which one is kept

// Shares of the duration; speeds in m/s.
struct PartPlan {
  const char* name;
  double until, speed;
  bool turns;
};
constexpr PartPlan kPartPlans[]{{"walk", 0.18, 0.7, false}, {"slow", 0.30, 0.22, false}, {"stop", 0.36, 0, false},
                                {"walk", 0.52, 0.8, false}, {"fast", 0.66, 1.2, false},  {"turn", 0.83, 0, true},
                                {"walk", 1.0, 0.65, false}};

struct Band {
  double low, high, amplitude;  // Hz; root mean square
};
// Slow drift, sway of steps, tremor of hands.
constexpr Band kPositionBands[]{{0.1, 0.5, 0.03}, {0.7, 2.2, 0.008}, {4, 9, 0.0006}};     // m
constexpr Band kRotationBands[]{{0.08, 0.45, 0.035}, {0.8, 2.4, 0.007}, {4, 9, 0.0006}};  // radians

double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

// Angle of a jolt: turns there and back within about seven widths. Steepest at 0.
double pulse(double x) {
  return x * std::exp(-0.5 * x * x);
}

// The way around the hall, by angle; its radius shrinks, so that later rounds do not repeat it.
glm::dvec2 wayAt(double angle, double start, double wobble) {
  const double shrunk = 1 - 0.012 * std::abs(angle - start), waved = 0.12 * std::sin(3 * angle + wobble);
  return {(3.35 * shrunk + waved) * std::cos(angle), (2.2 * shrunk + waved) * std::sin(angle)};
}

// Sharp and jolted runs in turn. Jolted runs have 1 to 5 frames, sharp ones 2 to 7.
std::vector<bool> drawnPlan(std::size_t frames, Random& random) {
  constexpr std::array kRuns{1, 1, 1, 1, 1, 1, 2, 2, 3, 5};
  std::vector<bool> plan;
  const auto add = [&](int count, bool jolted) { plan.insert(plan.end(), std::size_t(count), jolted); };
  while (plan.size() < frames) {
    add(2 + int(random.uniform(0, 5.999)), false);
    add(kRuns[std::size_t(random.uniform(0, double(kRuns.size()) - 0.001))], true);
  }
  plan.resize(frames);
  // The last frames stay sharp, as each jolted run has sharp frames on both sides.
  for (std::size_t i = frames > 2 ? frames - 2 : 0; i < frames; ++i) plan[i] = false;
  return plan;
}

// Largest deviation from kJoltedShare of the share of jolted frames that a choice of every n-th frame gets.
double unevenness(const std::vector<bool>& plan) {
  double largest = 0;
  for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 6u, 8u, 10u, 12u, 15u, 20u, 24u, 30u, 40u, 45u, 60u}) {
    std::size_t chosen = 0, jolted = 0;
    for (std::size_t i = 0; i < plan.size(); i += n, ++chosen) jolted += plan[i];
    if (chosen >= 6 || n == 1) largest = std::max(largest, std::abs(double(jolted) / double(chosen) - kJoltedShare));
  }
  return largest;
}

}  // namespace

double HandHeldWalk::Shake::at(double time) const {
  double sum = 0;
  for (const Wave& wave : waves) sum += wave.amplitude * std::sin(kTurn * wave.frequency * time + wave.phase);
  return sum;
}

HandHeldWalk::HandHeldWalk(const HandHeldWalkOptions& options) : options_(options) {
  check(options.seconds > 0 && options.fps > 0 && options.seconds * options.fps >= 8, ErrorCode::invalidInput,
        "a walk of {} s at {} frames a second has fewer than 8 frames", options.seconds, options.fps);
  check(options.shutter > 0 && options.shutter * options.fps <= kMaxShutterShare, ErrorCode::invalidInput,
        "an exposure of {} s is more than {} of the time between frames", options.shutter, kMaxShutterShare);
  planFrames();
  planSpeed();
  planShake();
  planJolts();
}

std::string HandHeldWalk::variableTime(const std::string& number) {
  return fmt::format("{0}+{1}*sin({2}*{0})", number, kRateShift, kRateWave);
}

void HandHeldWalk::planFrames() {
  const auto count = std::size_t(std::lround(options_.seconds * options_.fps));
  for (std::size_t i = 0; i < count; ++i)
    times_.push_back((double(i) + (options_.variableRate ? kRateShift * std::sin(kRateWave * double(i)) : 0)) /
                     options_.fps);
  double from = 0;
  for (const PartPlan& part : kPartPlans) {
    const auto first = std::ranges::lower_bound(times_, from * options_.seconds) - times_.begin();
    parts_.push_back({part.name, std::size_t(first), part.speed});
    from = part.until;
  }
}

double HandHeldWalk::speedAt(double time) const {
  double speed = 0, from = 0;
  for (const PartPlan& part : kPartPlans) {
    const double change = kChange * (part.until - from);
    speed = std::lerp(speed, part.speed, smooth((time / options_.seconds - from) / change));
    from = part.until;
  }
  return speed;
}

void HandHeldWalk::planSpeed() {
  Random random(options_.seed);
  start_ = random.uniform(0, kTurn);
  wobble_ = random.uniform(0, kTurn);
  direction_ = random.uniform(0, 1) < 0.5 ? -1 : 1;
  double travelled = 0, angle = start_, turned = 0;
  for (double time = 0; time <= options_.seconds + kStep; time += kStep) {
    travelled_.push_back(travelled);
    around_.push_back(angle);
    turned_.push_back(turned);
    const double speed = speedAt(time);
    constexpr double kDelta = 1e-4;
    const double metresPerRadian =
        glm::length(wayAt(angle + kDelta, start_, wobble_) - wayAt(angle - kDelta, start_, wobble_)) / (2 * kDelta);
    travelled += speed * kStep;
    angle += direction_ * speed * kStep / metresPerRadian;
    double from = 0;
    for (const PartPlan& part : kPartPlans) {
      const double share = (time / options_.seconds - from) / (part.until - from);
      // Turns after the camera has stopped, and before it walks on.
      if (part.turns) turned += kTurnSpeed * kStep * smooth((share - kChange) / 0.15) * smooth((1 - share) / 0.1);
      from = part.until;
    }
  }
}

void HandHeldWalk::planShake() {
  Random random(options_.seed + 1);
  const auto add = [&](Shake& shake, const Band& band) {
    constexpr int kWaves = 4;
    for (int i = 0; i < kWaves; ++i)
      shake.waves.push_back(
          {random.uniform(band.low, band.high), random.uniform(0, kTurn), band.amplitude * std::sqrt(2.0 / kWaves)});
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const Band& band : kPositionBands) add(position_[axis], band);
    for (const Band& band : kRotationBands) add(rotation_[axis], band);
  }
  add(look_, {0.03, 0.09, 0.45});
  add(amount_, {0.03, 0.12, 0.35});
}

void HandHeldWalk::planJolts() {
  Random random(options_.seed + 2);
  double best = 1;
  for (int i = 0; i < kPlans; ++i) {
    std::vector<bool> plan = drawnPlan(times_.size(), random);
    if (const double uneven = unevenness(plan); uneven < best) {
      best = uneven;
      jolted_ = std::move(plan);
    }
  }
  const double width = kPulse / options_.fps;
  for (std::size_t i = 0; i < times_.size(); ++i) {
    if (!jolted_[i]) continue;
    // Motion during the exposure, which reaches from −shutter/2 to shutter/2. A pinhole's focal length is half its
    // width by the tangent of half its angle.
    const double smear = random.uniform(kLeastSmear, kMostSmear) * 2 * std::tan(options_.angle / 2);
    const double direction = random.uniform(0, kTurn);
    jolts_.push_back(
        {times_[i], {std::cos(direction), std::sin(direction), 0}, smear / (2 * pulse(options_.shutter / 2 / width))});
  }
}

double HandHeldWalk::tableAt(const std::vector<double>& table, double time) const {
  const double at = std::clamp(time / kStep, 0.0, double(table.size() - 1));
  const auto before = std::min(std::size_t(at), table.size() - 2);
  return std::lerp(table[before], table[before + 1], at - double(before));
}

Pose HandHeldWalk::steadyPoseAt(double time) const {
  const double angle = tableAt(around_, time);
  const glm::dvec2 here = wayAt(angle, start_, wobble_);
  const glm::dvec2 ahead = direction_ * (wayAt(angle + 1e-4, start_, wobble_) - wayAt(angle - 1e-4, start_, wobble_));
  // The camera looks ahead and towards the nearer wall, as somebody does who films a room.
  const double outwards = direction_ > 0 ? 0.3 : -0.3;
  const double yaw = std::atan2(-ahead.x, -ahead.y) + outwards + look_.at(time) + tableAt(turned_, time);
  return {{here.x, kEyes, here.y},
          glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(-0.12, glm::dvec3(1, 0, 0))};
}

Pose HandHeldWalk::poseAt(double time) const {
  Pose pose = steadyPoseAt(time);
  const double amount = std::max(0.3, 1 + amount_.at(time));
  const double steps = kTurn * tableAt(travelled_, time) / kStride;
  const double bounce = kBounce * std::min(1.0, speedAt(time) / kFullBounce);
  const glm::dvec3 moved(position_[0].at(time), position_[1].at(time), position_[2].at(time));
  pose.position += amount * moved + glm::dvec3(0, bounce * std::cos(steps), 0) +
                   pose.rotation * glm::dvec3(bounce * std::sin(steps / 2), 0, 0);
  const auto turn = [](double radians, glm::dvec3 axis) { return glm::angleAxis(radians, axis); };
  pose.rotation = pose.rotation * turn(amount * rotation_[0].at(time), {0, 1, 0}) *
                  turn(0.7 * amount * rotation_[1].at(time), {1, 0, 0}) *
                  turn(0.6 * amount * rotation_[2].at(time), {0, 0, 1});
  const double width = kPulse / options_.fps, reach = 8 * width;
  for (auto jolt = std::ranges::lower_bound(jolts_, time - reach, {}, &Jolt::time);
       jolt != jolts_.end() && jolt->time < time + reach; ++jolt)
    pose.rotation = pose.rotation * turn(jolt->radians * pulse((time - jolt->time) / width), jolt->axis);
  pose.rotation = glm::normalize(pose.rotation);
  return pose;
}

}  // namespace ibr
