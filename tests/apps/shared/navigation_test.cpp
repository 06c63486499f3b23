// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/navigation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "ibr/error.h"

using namespace ibr;
using namespace ibr::app;

namespace {

const glm::dvec3 kUps[] = {{0, 1, 0}, {0, 0, 1}, glm::normalize(glm::dvec3(0.1, -0.9, 0.2))};

Navigation standing(glm::dvec3 position = glm::dvec3(0), glm::dvec3 up = {0, 1, 0}) {
  Navigation state;
  state.up = up;
  const glm::dvec3 aside = std::abs(up.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 back = glm::normalize(glm::cross(aside, up)), right = glm::cross(up, back);
  state.pose = {position, glm::normalize(glm::quat_cast(glm::dmat3(right, up, back)))};
  return state;
}

double heightOf(const Navigation& state) {
  return std::asin(std::clamp(glm::dot(viewAxis(state.pose), state.up), -1.0, 1.0));
}

// Sine of the roll: deviation of the image's right axis from the horizon.
double rollOf(const Navigation& state) {
  return glm::dot(state.pose.rotation * glm::dvec3(1, 0, 0), state.up);
}

// Navigates with keys held and an even turn for `seconds`, then without input for half a second.
Navigation flown(Navigation state, double seconds, int rate, glm::dvec3 move, glm::dvec2 lookPerSecond) {
  const int steps = int(std::lround(seconds * rate));
  const double dt = 1.0 / rate;
  for (int i = 0; i < steps; ++i) navigate(state, {.seconds = dt, .move = move, .look = lookPerSecond * dt});
  for (int i = 0; i < rate / 2; ++i) navigate(state, {.seconds = dt});
  return state;
}

}  // namespace

TEST_CASE("flying does not depend on the frame rate, near the origin and far from it") {
  for (const double far : {0.0, 1e6}) {
    const glm::dvec3 start(far, -far, far);
    for (const glm::dvec2 turn : {glm::dvec2(0), glm::dvec2(300, 40)}) {
      const Navigation at144 = flown(standing(start), 2, 144, {0.3, 0.5, -1}, turn);
      const double way = glm::distance(at144.pose.position, start);
      CHECK(way > 1);
      for (const int rate : {10, 30, 60}) {
        CAPTURE(rate, far, turn.x);
        const Navigation other = flown(standing(start), 2, rate, {0.3, 0.5, -1}, turn);
        CHECK(glm::distance(other.pose.position, at144.pose.position) < 0.01 * way);
        CHECK(glm::length(viewAxis(other.pose) - viewAxis(at144.pose)) < 1e-6);
        if (turn.x == 0) CHECK(glm::distance(other.pose.position, at144.pose.position) < 1e-8 * std::max(1.0, far));
      }
    }
  }
}

TEST_CASE("flying follows the view's axes, has three speeds, and starts and stops smoothly") {
  for (const glm::dvec3 up : kUps) {
    const Navigation start = standing({1, 2, 3}, up);
    const auto moved = [&](NavigationInput input) {
      Navigation state = start;
      input.seconds = 0.01;
      for (int i = 0; i < 300; ++i) navigate(state, input);
      return state.pose.position - start.pose.position;
    };
    const glm::dvec3 right = start.pose.rotation * glm::dvec3(1, 0, 0),
                     back = start.pose.rotation * glm::dvec3(0, 0, 1);
    const double way = 3 - 0.1;  // at unit speed, minus the start-up by inertia
    CHECK(glm::length(moved({.move = {1, 0, 0}}) - way * right) < 1e-3);
    CHECK(glm::length(moved({.move = {0, 0, -1}}) + way * back) < 1e-3);
    CHECK(glm::length(moved({.move = {0, 1, 0}}) - way * up) < 1e-3);
    CHECK(glm::length(moved({.move = {0, 0, -1}, .fast = true})) == Approx(4 * way));
    CHECK(glm::length(moved({.move = {0, 0, -1}, .slow = true})) == Approx(way / 4));
    CHECK(glm::length(moved({.move = {1, 0, -1}})) == Approx(way));   // diagonal motion is not faster
    CHECK(glm::length(moved({.move = {100, 0, 0}})) == Approx(way));  // out-of-range input is clamped
    CHECK(glm::length(moved({.move = {0.5, 0, 0}})) == Approx(way / 2));
  }
  Navigation state = standing();
  CHECK(navigate(state, {.seconds = 0.001, .move = {1, 0, 0}}));
  CHECK(glm::length(state.velocity) < 0.02);
  int steps = 0;
  while (navigate(state, {.seconds = 0.05})) REQUIRE(++steps < 100);
  const Pose rest = state.pose;
  CHECK(!navigate(state, {.seconds = 0.05}));
  CHECK((state.pose.position == rest.position && state.pose.rotation == rest.rotation));
}

TEST_CASE("each notch of the wheel changes the speed by the same factor") {
  Navigation state = standing();
  navigate(state, {.wheel = 3});
  CHECK(state.speed == Approx(1.2 * 1.2 * 1.2));
  navigate(state, {.wheel = -3});
  CHECK(state.speed == Approx(1));
  for (int i = 0; i < 100; ++i) navigate(state, {.wheel = -1e9});
  CHECK(state.speed > 0);
  for (int i = 0; i < 100; ++i) navigate(state, {.wheel = 1e9});
  CHECK(std::isfinite(state.speed));
}

TEST_CASE("looking around adds no roll, stops at 89 degrees and does not depend on the step size") {
  for (const glm::dvec3 up : kUps) {
    Navigation state = standing({}, up);
    const glm::dvec3 right = state.pose.rotation * glm::dvec3(1, 0, 0);
    navigate(state, {.look = {60, 0}});
    CHECK(glm::dot(viewAxis(state.pose), right) > 0.05);
    navigate(state, {.look = {0, 60}});
    CHECK(heightOf(state) == Approx(-0.1));  // a tenth of the field of view, downwards
    for (int i = 0; i < 2000; ++i) navigate(state, {.look = {13.7, 5.0 * std::sin(i * 0.1)}});
    CHECK(std::abs(rollOf(state)) < 1e-9);
    CHECK(std::abs(glm::length(state.pose.rotation) - 1) < 1e-14);
    navigate(state, {.look = {0, 1e7}});
    CHECK(glm::degrees(heightOf(state)) == Approx(-89));
    navigate(state, {.look = {123, -1e300}});
    CHECK(glm::degrees(heightOf(state)) == Approx(89));
    CHECK(std::abs(rollOf(state)) < 1e-9);
    Navigation once = standing({}, up), often = once;
    navigate(once, {.look = {100, 0}});
    for (int i = 0; i < 100; ++i) navigate(often, {.look = {1, 0}});
    CHECK(glm::length(viewAxis(once.pose) - viewAxis(often.pose)) < 1e-12);
  }
}

TEST_CASE("a rolled view keeps its roll, and a vertical view returns without a jump") {
  Navigation state = standing();
  state.pose.rotation = state.pose.rotation * glm::angleAxis(0.3, glm::dvec3(0, 0, 1));
  const double roll = rollOf(state);
  navigate(state, {.look = {500, 0}});
  CHECK(rollOf(state) == Approx(roll));
  state.pose = levelled(state.pose, state.up);
  CHECK(std::abs(rollOf(state)) < 1e-12);

  for (const double height : {90.0, -90.0, 89.7}) {
    Navigation steep = standing();
    steep.pose.rotation = glm::angleAxis(glm::radians(height), glm::dvec3(1, 0, 0));
    const glm::dvec3 before = viewAxis(steep.pose);
    navigate(steep, {.look = {10, 0}});
    CHECK(glm::length(viewAxis(steep.pose) - before) < 1e-3);
    navigate(steep, {.look = {0, height > 0 ? -50.0 : 50.0}});  // further input does not change the view
    CHECK(glm::length(viewAxis(steep.pose) - before) < 1e-3);
    navigate(steep, {.look = {0, height > 0 ? 60.0 : -60.0}});
    CHECK(std::abs(heightOf(steep)) == Approx(std::abs(glm::radians(height)) - 0.1).margin(1e-6));
    CHECK(std::abs(rollOf(steep)) < 1e-6);
    CHECK(std::isfinite(steep.pose.rotation.x));
    CHECK(levelled({{}, glm::angleAxis(glm::radians(90.0), glm::dvec3(1, 0, 0))}, {0, 1, 0}).rotation.w > 0);
  }
}

TEST_CASE("an orbit keeps the centre's distance and pixel") {
  for (const double far : {0.0, 1e6})
    for (const glm::dvec3 up : kUps) {
      Navigation state = standing({far, far, -far}, up);
      const Intrinsics k = pinholeFromFov(640, 480, 1);
      const auto centre = pickedPoint({k, state.pose}, {500.25, 77.5}, 3);
      REQUIRE(centre);
      Navigation free = state;
      navigate(free, {.orbit = {50, 20}});
      CHECK(free.pose.position == state.pose.position);  // without a centre there is no orbit
      state.centre = centre;
      const double distance = glm::distance(*centre, state.pose.position);
      const auto seen = [&] {
        return project(k, glm::conjugate(state.pose.rotation) * (*centre - state.pose.position)).value();
      };
      const glm::dvec3 right = state.pose.rotation * glm::dvec3(1, 0, 0), start = state.pose.position;
      navigate(state, {.orbit = {30, 0}});
      CHECK(glm::dot(state.pose.position - start, right) < -0.1);  // the drag pulls the world to the right
      navigate(state, {.orbit = {0, 30}});
      CHECK(glm::dot(state.pose.position - start, up) > 0.1);
      for (int i = 0; i < 500; ++i) {
        navigate(state, {.orbit = {17, 9 * std::cos(0.05 * i)}});
        REQUIRE(glm::distance(*centre, state.pose.position) == Approx(distance).epsilon(1e-9));
        REQUIRE(glm::distance(seen(), glm::dvec2(500.25, 77.5)) < 1e-5 * std::max(1.0, far / 1e5));
        REQUIRE(std::abs(heightOf(state)) < glm::radians(89.001));
      }
      CHECK(std::abs(rollOf(state)) < 1e-9);
    }
  const Camera camera{pinholeFromFov(10, 10, 1), {}};
  for (const double depth : {0.0, -1.0, double(INFINITY), std::nan("")}) CHECK(!pickedPoint(camera, {5, 5}, depth));
  CHECK(glm::distance(*pickedPoint(camera, {5, 5}, 2), glm::dvec3(0, 0, -2)) < 1e-12);
}

TEST_CASE("a flight is eased, ends exactly at its goal, and is ended by input") {
  Navigation start = standing({1e6, 0, 0});
  start.velocity = {5, 0, 0};
  const Pose goal{{1e6 + 10, 1, -7}, glm::normalize(glm::dquat(0.2, -0.5, 0.7, 0.1))};
  for (const int rate : {30, 60, 144}) {
    Navigation state = start;
    flyTo(state, goal, 0.7, 0.5);
    double fastest = 0, first = 0;
    int steps = 0;
    glm::dvec3 last = state.pose.position;
    while (navigate(state, {.seconds = 1.0 / rate})) {
      const double step = glm::distance(state.pose.position, last);
      if (steps++ == 0) first = step;
      fastest = std::max(fastest, step);
      last = state.pose.position;
    }
    CHECK(std::abs(steps + 1 - rate / 2) <= 1);
    CHECK(first < 0.2 * fastest);
    CHECK(glm::distance(last, goal.position) < 0.2 * fastest);
    CHECK((state.pose.position == goal.position && state.pose.rotation == goal.rotation && state.fovY == 0.7));
    CHECK(!navigate(state, {.seconds = 0.1}));
    CHECK(state.pose.position == goal.position);
  }
  for (const NavigationInput& hand :
       {NavigationInput{.seconds = 0.01, .move = {0, 0, 1}}, NavigationInput{.seconds = 0.01, .look = {1, 0}}}) {
    Navigation state = start;
    flyTo(state, goal, 0.7, 1);
    navigate(state, {.seconds = 0.5});
    const glm::dvec3 there = state.pose.position;
    navigate(state, hand);
    CHECK(!state.flight);
    CHECK(glm::distance(state.pose.position, there) < 0.1);
  }
  Navigation state = start;
  flyTo(state, goal, 0.7, 0);
  CHECK((state.pose.position == goal.position && !state.flight));
  flyTo(state, start.pose, 1, 10);
  navigate(state, {.seconds = 0.5, .wheel = 1});  // the speed may change during the flight
  CHECK(state.flight);
  CHECK_THROWS_AS(flyTo(state, goal, 1, std::nan("")), Error);
  CHECK_THROWS_AS(flyTo(state, goal, 1, -1), Error);
}

TEST_CASE("time steps of zero or very long are handled, and input that is not finite is refused") {
  Navigation state = standing();
  navigate(state, {.seconds = 0, .move = {1, 1, 1}});
  CHECK(state.pose.position == glm::dvec3(0));
  navigate(state, {.seconds = 1e9, .move = {1, 0, 0}});
  CHECK(glm::length(state.pose.position) < 1.01);  // after the machine slept, the camera has not moved far
  const Navigation before = state;
  const double nan = std::nan("");
  const NavigationInput wrong[] = {
      {.seconds = nan},   {.seconds = -1e-9},       {.seconds = INFINITY}, {.move = {0, nan, 0}},
      {.look = {nan, 0}}, {.orbit = {0, INFINITY}}, {.wheel = nan},        {.look = {0, -double(INFINITY)}}};
  for (const NavigationInput& input : wrong) {
    CHECK_THROWS_AS(navigate(state, input), Error);
    CHECK((state.pose.position == before.pose.position && state.pose.rotation == before.pose.rotation &&
           state.velocity == before.velocity && state.speed == before.speed));
  }
}

TEST_CASE("navigation stays within the bounds at any time step") {
  const RoamingBounds bounds{{{0, 0, 0}, {2, 0, 0}}, {{0, 1}}, 0.5};
  for (const int rate : {2, 60}) {
    Navigation state = standing({0.1, 0.1, 0});
    for (int i = 0; i < 20 * rate; ++i) {
      navigate(state, {.seconds = 1.0 / rate, .move = {1, 0.2, -1}, .look = {3, 0}, .fast = true}, &bounds);
      REQUIRE(distanceTo(bounds, state.pose.position) < 0.5 + 1e-9);
    }
  }
}
