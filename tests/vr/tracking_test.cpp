// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/tracking.h"

#include <catch2/catch.hpp>
#include <glm/gtc/constants.hpp>

#include "any_tracking.h"

using namespace ibr;
using namespace ibr::app;
using ibr::test::angleBetween;
using ibr::test::AnyTracking;
using ibr::test::worldRounding;

namespace {

glm::dvec3 ground(const Tracking& tracking, const Pose& head) {
  return inWorld(tracking, glm::dvec3(head.position.x, 0, head.position.z));
}

const Pose kLevelHead{{0, 1.7, 0}, {1, 0, 0, 0}};

}  // namespace

TEST_CASE("tracking: poses round trip through the world at any origin, scale and up") {
  AnyTracking any(1);
  for (const double far : {0.0, 1.0, 1e7})
    for (int i = 0; i < 300; ++i) {
      const Tracking tracking = any.tracking(far, 6);
      const Pose head = any.head(), world = inWorld(tracking, head), back = inTracking(tracking, world);
      const double rounding = worldRounding(tracking) / tracking.unitsPerMetre;
      REQUIRE(glm::distance(back.position, head.position) <= rounding);
      REQUIRE(std::abs(glm::dot(back.rotation, head.rotation)) >= 1 - 1e-14);
      REQUIRE(glm::distance(inTracking(tracking, world.position), back.position) == 0);
      // Lengths grow by the scale, and axes turn with the tracking space.
      const glm::dvec3 a = inWorld(tracking, glm::dvec3(0)), b = inWorld(tracking, glm::dvec3(0, 0, -1));
      REQUIRE(glm::distance(a, b) == Approx(tracking.unitsPerMetre).margin(worldRounding(tracking)));
      REQUIRE(angleBetween(viewAxis(world), tracking.rotation * viewAxis(head)) < 1e-12);
    }
}

TEST_CASE("tracking: world = origin + rotation · (unitsPerMetre · point)") {
  const Tracking tracking{{10, 20, 30}, glm::angleAxis(glm::half_pi<double>(), glm::dvec3(0, 1, 0)), 2};
  CHECK(glm::distance(inWorld(tracking, glm::dvec3(1, 2, 3)), glm::dvec3(16, 24, 28)) < 1e-12);
  CHECK(glm::distance(inTracking(tracking, glm::dvec3(16, 24, 28)), glm::dvec3(1, 2, 3)) < 1e-12);
}

TEST_CASE("tracking: levelled to any up direction, also straight down") {
  AnyTracking any(2);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 up = any.unit();
    CHECK(angleBetween(upInWorld(levelTracking(any.between(0.01, 100) * up)), up) < 1e-12);
  }
  for (const double off : {0.0, 1e-3, 1e-7, 1e-12}) {
    const glm::dvec3 down = glm::normalize(glm::dvec3(off, -1, off));
    CHECK(angleBetween(upInWorld(levelTracking(down)), down) < 1e-5 * (off > 0 ? 1 : 1e-9));
  }
  CHECK(levelTracking({0, 1, 0}).rotation == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("facing: the horizontal part of the view axis, also for views straight up or down") {
  const auto pitched = [](double heading, double pitch) {
    return glm::angleAxis(heading, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
  };
  for (const double heading : {-3.0, -1.0, 0.0, 0.3, 2.5})
    for (const double pitch : {-glm::half_pi<double>(), -1.55, -1.45, -0.5, 0.0, 1.0, 1.5, glm::half_pi<double>()}) {
      const glm::dquat rotation = pitched(heading, pitch);
      CHECK(headingOf(rotation) == Approx(heading).margin(1e-9));
      const glm::dvec3 facing = facingOf(rotation);
      CHECK(glm::length(facing) == Approx(1).margin(1e-12));
      CHECK(std::abs(facing.y) < 1e-12);
    }
  // A trembling head that looks at its feet keeps its heading.
  for (const double roll : {-0.02, -0.001, 0.0, 0.003, 0.02})
    for (const double pitch : {-1.59, -1.5708, -1.56}) {
      const glm::dquat rotation = glm::angleAxis(roll, glm::dvec3(0, 0, 1)) * pitched(0, pitch);
      CHECK(std::abs(headingOf(rotation)) < 0.03);
    }
  // With any up axis.
  AnyTracking any(3);
  for (int i = 0; i < 100; ++i) {
    const Tracking tracking = any.tracking(0, 0);
    const Pose head = any.head();
    const glm::dvec3 facing = facingOf(tracking.rotation * head.rotation, upInWorld(tracking));
    REQUIRE(angleBetween(facing, tracking.rotation * facingOf(head.rotation)) < 1e-9);
  }
}

TEST_CASE("turning keeps the head's position and rotates the view to the left by the angle") {
  AnyTracking any(4);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 300; ++i) {
      const Tracking before = any.tracking(far, 3);
      const Pose head = any.head();
      const double radians = any.between(-3, 3);
      const Tracking after = turned(before, head, radians);
      const double rounding = worldRounding(before);
      REQUIRE(glm::distance(inWorld(after, head.position), inWorld(before, head.position)) <= 4 * rounding);
      REQUIRE(angleBetween(upInWorld(after), upInWorld(before)) < 1e-14);
      REQUIRE(after.unitsPerMetre == before.unitsPerMetre);
      const glm::dvec3 seen = inWorld(before, head).rotation * glm::dvec3(0.3, 0.2, -1);
      const glm::dvec3 expected = glm::angleAxis(radians, upInWorld(before)) * seen;
      REQUIRE(angleBetween(inWorld(after, head).rotation * glm::dvec3(0.3, 0.2, -1), expected) < 1e-12);
    }
  const Tracking left = turned({}, kLevelHead, 0.5);
  CHECK(inWorld(left, glm::dvec3(0, 0, -1)).x < 0);
}

TEST_CASE("turning to a direction faces its horizontal part, and a vertical direction changes nothing") {
  AnyTracking any(5);
  for (int i = 0; i < 300; ++i) {
    const Tracking before = any.tracking(1e4, 3);
    const Pose head = any.head();
    const glm::dvec3 up = upInWorld(before), wanted = any.between(0.1, 10) * any.unit();
    const Tracking after = turnedTo(before, head, wanted);
    const glm::dvec3 level = wanted - glm::dot(wanted, up) * up;
    REQUIRE(angleBetween(facingOf(inWorld(after, head).rotation, up), level) < 1e-6);
    REQUIRE(glm::distance(inWorld(after, head.position), inWorld(before, head.position)) <= 4 * worldRounding(before));
    const Tracking same = turnedTo(before, head, 3.0 * up);
    REQUIRE(same.rotation == before.rotation);
    REQUIRE(same.origin == before.origin);
  }
  CHECK(turnedTo({}, kLevelHead, glm::dvec3(0)).rotation == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("a change of scale keeps the head's horizontal position and the kept height") {
  AnyTracking any(6);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 300; ++i) {
      const Tracking before = any.tracking(far, 2);
      const Pose head = any.head();
      const double kept = any.between(0, 2), scale = before.unitsPerMetre * std::pow(10, any.between(-3, 3));
      const Tracking after = scaled(before, head, kept, scale);
      const glm::dvec3 up = upInWorld(before), gone = inWorld(after, head.position) - inWorld(before, head.position);
      const double rounding = 4 * (worldRounding(before) + worldRounding(after));
      REQUIRE(after.unitsPerMetre == scale);
      REQUIRE(after.rotation == before.rotation);
      REQUIRE(glm::length(gone - glm::dot(gone, up) * up) <= rounding);
      const glm::dvec3 pin(head.position.x, kept, head.position.z);
      REQUIRE(glm::distance(inWorld(after, pin), inWorld(before, pin)) <= rounding);
      // With height 0, the floor stays in place.
      REQUIRE(glm::distance(ground(scaled(before, head, 0, scale), head), ground(before, head)) <= rounding);
    }
}

TEST_CASE("standing on a point puts the head above the point without rotation") {
  AnyTracking any(7);
  for (int i = 0; i < 100; ++i) {
    const Tracking before = any.tracking(1e5, 3);
    const Pose head = any.head();
    const glm::dvec3 wanted = 1e5 * any.unit();
    const Tracking after = stoodOn(before, head, wanted);
    REQUIRE(glm::distance(ground(after, head), wanted) <= 4e-14 * 1e5 + 4 * worldRounding(before));
    REQUIRE(after.rotation == before.rotation);
    REQUIRE(after.unitsPerMetre == before.unitsPerMetre);
  }
}

TEST_CASE("after recentring the head keeps its pose in the world, on the same floor") {
  AnyTracking any(8);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 300; ++i) {
      const Tracking before = any.tracking(far, 3);
      const Pose head = any.head();
      const Pose newInOld{{any.between(-3, 3), 0, any.between(-3, 3)},
                          glm::angleAxis(any.between(-3, 3), glm::dvec3(0, 1, 0))};
      const Pose same{glm::conjugate(newInOld.rotation) * (head.position - newInOld.position),
                      glm::conjugate(newInOld.rotation) * head.rotation};
      const Tracking after = recentred(before, newInOld);
      const Pose was = inWorld(before, head), is = inWorld(after, same);
      REQUIRE(glm::distance(was.position, is.position) <= 8 * worldRounding(before));
      REQUIRE(std::abs(glm::dot(was.rotation, is.rotation)) >= 1 - 1e-13);
      REQUIRE(angleBetween(upInWorld(after), upInWorld(before)) < 1e-13);
    }
  // A new floor, even one that is not level, becomes the world's floor.
  const Tracking before = levelTracking({0, 1, 0}, 2);
  const Tracking after = recentred(before, {{1, -0.4, 2}, glm::angleAxis(0.2, glm::dvec3(1, 0, 0))});
  CHECK(glm::distance(after.origin, glm::dvec3(2, 0, 4)) < 1e-12);
  CHECK(angleBetween(upInWorld(after), {0, 1, 0}) < 1e-12);
}
