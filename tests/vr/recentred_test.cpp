// SPDX-License-Identifier: Apache-2.0
// Recentring of the tracking space while a person walks.
#include <catch2/catch.hpp>
#include <limits>

#include "walker.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

Pose seenFrom(const Pose& space, const Pose& pose) {
  const glm::dquat back = glm::conjugate(space.rotation);
  return {back * (pose.position - space.position), glm::normalize(back * pose.rotation)};
}

Pose anySpace(AnyTracking& any) {
  return {{any.between(-3, 3), 0, any.between(-3, 3)}, glm::angleAxis(any.between(-3, 3), glm::dvec3(0, 1, 0))};
}

void checkSame(const Pose& a, const Pose& b, double margin) {
  REQUIRE(glm::distance(a.position, b.position) <= margin);
  REQUIRE(std::abs(glm::dot(a.rotation, b.rotation)) >= 1 - 1e-9);
}

}  // namespace

TEST_CASE("recentred: the person's pose in the world is kept, for known and unknown motion of the space") {
  AnyTracking any(31);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 60; ++i) {
      const Tracking to = any.tracking(far, 2);
      for (const bool known : {true, false}) {
        Walker walker(to);
        walker.input.head = any.head();
        walker.step();
        const Pose before = walker.head();
        const Pose space = anySpace(any);
        recentred(walker.state, known ? std::optional(space) : std::nullopt);
        walker.input.head = seenFrom(space, *walker.input.head);
        const WalkOutput output = walker.step();
        checkSame(walker.head(), before, 16 * worldRounding(to) + 1e-9 * to.unitsPerMetre);
        REQUIRE(!output.jumped);
        REQUIRE(output.fade == 0);
        REQUIRE(angleBetween(upInWorld(output.tracking), walker.place.up) < 1e-9);
        // Only once: later head motion is the person's own.
        const Tracking tracking = output.tracking;
        walker.input.head = any.head();
        REQUIRE(same(walker.step().tracking, tracking));
      }
    }
}

TEST_CASE("recentred: the pose is kept after several recentrings without a tracked head") {
  AnyTracking any(32);
  for (int i = 0; i < 60; ++i) {
    Walker walker(any.tracking(10, 1));
    walker.input.head = any.head();
    walker.step();
    const Pose before = walker.head();
    Pose head = *walker.input.head;
    walker.input.head.reset();
    for (int k = 0; k < 3; ++k) {
      const bool known = any.between(0, 1) < 0.5;
      const Pose space = anySpace(any);
      head = seenFrom(space, head);
      recentred(walker.state, known ? std::optional(space) : std::nullopt);
      walker.step();
    }
    walker.input.head = head;
    walker.step();
    checkSame(walker.head(), before, 1e-7 * walker.state.tracking.unitsPerMetre);
  }
}

TEST_CASE("recentred: a new floor height becomes the floor, and changes the person's height") {
  Walker walker;
  recentred(walker.state, Pose{{0, 0.3, 0}, {1, 0, 0, 0}});
  walker.input.head->position.y -= 0.3;
  walker.step();
  CHECK(inTracking(walker.state.tracking, walker.place.spots[2].position).y == Approx(1.6));
  CHECK(walker.head().position.y == Approx(1.4));
  CHECK(walker.awayFrom(2) < 1e-9);
}

TEST_CASE("recentred: before the head is tracked, or by an invalid pose, the start position is kept") {
  Walker walker;
  walker.state = startWalk(walker.place, walker.settings, 4);
  recentred(walker.state, std::nullopt);
  recentred(walker.state, Pose{{1, 0, 2}, glm::angleAxis(1.0, glm::dvec3(0, 1, 0))});
  recentred(walker.state, Pose{{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {1, 0, 0, 0}});
  walker.step();
  CHECK(walker.awayFrom(4) < 1e-9);
  CHECK(angleBetween(facingOf(walker.head().rotation), walker.place.spots[4].facing) < 1e-9);
}

TEST_CASE("recentred: a teleport in progress still arrives") {
  Walker walker;
  walker.input.teleportTo = 1;
  walker.step();
  walker.input.teleportTo.reset();
  const Pose space{{1, 0, -2}, glm::angleAxis(-2.0, glm::dvec3(0, 1, 0))};
  recentred(walker.state, space);
  walker.input.head = seenFrom(space, *walker.input.head);
  walker.steps(60);
  CHECK(walker.awayFrom(1) < 1e-9);
}
