// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/locomotion.h"

#include <catch2/catch.hpp>
#include <limits>

#include "walker.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();

Tracking tilted(double far = 100, double scale = 2) {
  AnyTracking any(21);
  Tracking tracking = any.tracking(far, 0);
  tracking.unitsPerMetre = scale;
  return tracking;
}

// Angle by which the head has turned to the left in the world, radians.
double turnedBy(const Walker& walker, const Pose& before) {
  const glm::dvec3 up = walker.place.up, a = facingOf(before.rotation, up), b = facingOf(walker.head().rotation, up);
  return std::atan2(glm::dot(glm::cross(a, b), up), glm::dot(a, b));
}

}  // namespace

TEST_CASE("walk: starts black, and fades in at the spot, facing as its photographs, when the head is tracked") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e7, 1e-3)}) {
    Walker walker(to);
    walker.state = startWalk(walker.place, walker.settings, 3);
    const auto head = std::exchange(walker.input.head, std::nullopt);
    for (int i = 0; i < 100; ++i) {
      const WalkOutput output = walker.step();
      REQUIRE(output.fade == 1);
      REQUIRE(!output.jumped);
    }
    walker.input.head = Pose{head->position, glm::angleAxis(2.0, glm::dvec3(0, 1, 0))};
    const WalkOutput first = walker.step();
    CHECK(first.jumped);
    CHECK(first.fade == 1);
    CHECK(first.arrived == 3u);
    CHECK(walker.awayFrom(3) < 1e-5);
    CHECK(angleBetween(facingOf(walker.head().rotation, walker.place.up), walker.place.spots[3].facing) < 1e-6);
    CHECK(inTracking(first.tracking, walker.place.spots[3].position).y == Approx(1.6).margin(1e-5));
    int frames = 0;
    double last = 1;
    while (walker.state.fade > 0 && frames < 1000) {
      const WalkOutput output = walker.step();
      REQUIRE(output.fade < last);
      REQUIRE(!output.jumped);
      last = output.fade;
      ++frames;
    }
    CHECK(frames == 18);  // 0.2 s
  }
}

TEST_CASE("walk: a spot chosen before the head is tracked sets the facing") {
  Walker walker;
  std::vector<Spot> spots = walker.place.spots.all();
  spots[1].facing = {1, 0, 0};
  walker.place.spots = Spots(std::move(spots));
  walker.state = startWalk(walker.place, walker.settings, 3);
  const auto head = std::exchange(walker.input.head, std::nullopt);
  walker.input.teleportTo = 1;
  walker.step();
  walker.input = {.seconds = kFrame, .head = head};
  CHECK(walker.step().arrived == 1u);
  CHECK(angleBetween(facingOf(walker.head().rotation), {1, 0, 0}) < 1e-9);
  walker.input.teleportTo = 3;
  walker.steps(40);
  CHECK(angleBetween(facingOf(walker.head().rotation), {1, 0, 0}) < 1e-9);
}

TEST_CASE("walk: in a scene without spots the person stands at the origin and cannot teleport") {
  Walker walker({}, 0, 0);
  CHECK(walker.step().fade == 0);
  CHECK(same(walker.state.tracking, Tracking{}));
  walker.hand(kRight).select = true;
  CHECK(walker.step().showMarks);
  walker.hand(kRight).select = false;
  walker.input.teleportTo = 0;
  walker.step();
  walker.input.teleportTo.reset();
  CHECK(walker.steps(60).fade == 0);
  CHECK(same(walker.state.tracking, Tracking{}));
  // A start at a spot that does not exist.
  const Walker at;
  CHECK(!startWalk(at.place, at.settings, 5).wanted);
}

TEST_CASE("walk: head motion leaves the tracking space unchanged, bit for bit") {
  Walker walker(tilted());
  AnyTracking any(22);
  const Tracking before = walker.state.tracking;
  for (int i = 0; i < 2000; ++i) {
    walker.input.head = any.head();
    for (HandInput& hand : walker.input.hands) hand.aim = any.head();
    const WalkOutput output = walker.step();
    REQUIRE(same(output.tracking, before));
    REQUIRE(output.fade == 0);
    REQUIRE(output.vignette == 0);
    REQUIRE(!output.showMarks);
  }
}

TEST_CASE("walk: holding select shows the target, and releasing select teleports through black, facing as before") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e7, 1e-3)})
    for (const Hand which : {kLeft, kRight}) {
      Walker walker(to);
      walker.input.head->rotation = glm::angleAxis(0.7, glm::dvec3(0, 1, 0));
      const Pose before = walker.head();
      walker.hand(which).select = true;
      WalkOutput output = walker.step();
      CHECK(output.showMarks);
      CHECK(output.hands[which].aiming);
      CHECK(!output.hands[which].pointed);
      CHECK(!output.hands[1 - which].aiming);
      walker.pointAt(which, walker.place.spots[4].position);
      CHECK(walker.step().hands[which].pointed == 4u);
      walker.pointAt(which, groundOf(walker.place.spots[1], walker.place.up, 1.6 * to.unitsPerMetre));
      CHECK(walker.step().hands[which].pointed == 1u);

      walker.hand(which).select = false;
      const Tracking tracking = walker.state.tracking;
      int out = 0, jumps = 0, frames = 0;
      for (; frames < 200 && (frames == 0 || walker.state.fade > 0); ++frames) {
        output = walker.step();
        if (output.jumped) {
          ++jumps;
          REQUIRE(output.fade == 1);
          REQUIRE(output.arrived == 1u);
        }
        if (jumps == 0) {
          ++out;
          REQUIRE(same(output.tracking, tracking));
        }
      }
      CHECK(jumps == 1);
      CHECK(out == 10);  // 0.12 s: black in the eleventh frame
      CHECK(frames == 29);
      CHECK(!output.showMarks);
      CHECK(walker.awayFrom(1) < 1e-5);
      CHECK(std::abs(turnedBy(walker, before)) < 1e-6);
      CHECK(inTracking(walker.state.tracking, walker.place.spots[1].position).y == Approx(1.6).margin(1e-5));
    }
}

TEST_CASE("walk: a press of one frame teleports, and a press without target does not") {
  Walker walker;
  walker.pointAt(kRight, walker.place.spots[0].position);
  walker.hand(kRight).select = true;
  walker.step();
  walker.hand(kRight).select = false;
  walker.steps(60);
  CHECK(walker.awayFrom(0) < 1e-9);

  const Tracking before = walker.state.tracking;
  walker.pointAt(kRight, walker.head().position + glm::dvec3(0, 9, 0));
  walker.hand(kRight).select = true;
  walker.steps(5);
  walker.hand(kRight).select = false;
  CHECK(walker.steps(60).fade == 0);
  CHECK(same(walker.state.tracking, before));
}

TEST_CASE("walk: the target stays the same while the hand trembles between two spots") {
  Walker walker;
  const glm::dvec3 hand = walker.hand(kRight).aim.position;
  const auto to = [&](std::size_t spot) {
    return glm::normalize(inTracking(walker.state.tracking, walker.place.spots[spot].position) - hand);
  };
  const auto point = [&](double share) {  // share of the way from one spot to the other
    walker.pointAt(kRight, inWorld(walker.state.tracking, hand + (1 - share) * to(3) + share * to(4)));
    return walker.step().hands[kRight].pointed;
  };
  walker.hand(kRight).select = true;
  CHECK(point(1) == 4u);
  for (const double share : {0.5, 0.45, 0.55, 0.45}) CHECK(point(share) == 4u);
  CHECK(point(0) == 3u);
  for (const double share : {0.5, 0.55, 0.45, 0.55}) CHECK(point(share) == 3u);
}

TEST_CASE("walk: a press on the panel goes to the panel, and a release on the panel does not teleport") {
  Walker walker;
  const Tracking before = walker.state.tracking;
  walker.pointAt(kRight, walker.place.spots[0].position);
  walker.hand(kRight).onPanel = walker.hand(kRight).select = true;
  WalkOutput output = walker.step();
  CHECK(output.hands[kRight].panelSelect);
  CHECK(!output.hands[kRight].aiming);
  walker.hand(kRight).onPanel = false;
  output = walker.step();
  CHECK(output.hands[kRight].panelSelect);  // the drag continues off the panel
  CHECK(!output.showMarks);
  walker.hand(kRight).select = false;
  CHECK(!walker.step().hands[kRight].panelSelect);
  CHECK(walker.steps(60).fade == 0);

  walker.hand(kRight).select = true;
  CHECK(walker.step().hands[kRight].pointed == 0u);
  walker.hand(kRight).onPanel = true;
  output = walker.step();
  CHECK(!output.hands[kRight].aiming);
  CHECK(!output.hands[kRight].panelSelect);
  walker.hand(kRight).select = false;
  walker.steps(60);
  CHECK(same(walker.state.tracking, before));
}

TEST_CASE("walk: presses do not teleport if the hand or head loses tracking") {
  const auto pressed = [](Walker& walker) {
    walker.pointAt(kRight, walker.place.spots[0].position);
    walker.hand(kRight).select = true;
    walker.step();
  };
  const auto released = [](Walker& walker) {
    const Tracking before = walker.state.tracking;
    walker.hand(kRight).select = false;
    walker.steps(60);
    return same(walker.state.tracking, before);
  };
  Walker lostHand;
  pressed(lostHand);
  lostHand.hand(kRight).active = false;
  CHECK(!lostHand.step().showMarks);
  lostHand.hand(kRight).active = true;  // still held: the release was not observed
  CHECK(!lostHand.step().showMarks);
  CHECK(released(lostHand));

  Walker broken;
  pressed(broken);
  const Pose aim = broken.hand(kRight).aim;
  broken.hand(kRight).aim.position.y = kNaN;
  CHECK(!broken.step().showMarks);
  broken.hand(kRight).aim = aim;
  CHECK(released(broken));

  Walker lostHead;
  pressed(lostHead);
  const auto head = std::exchange(lostHead.input.head, std::nullopt);
  CHECK(!lostHead.step().hands[kRight].pointed);
  lostHead.hand(kRight).select = false;
  lostHead.step();
  lostHead.input.head = head;
  CHECK(released(lostHead));

  Walker held;  // held since before the document was opened
  pressed(held);
  held.state = startWalk(held.place, held.settings, 2);
  CHECK(!held.steps(40).showMarks);
  CHECK(released(held));
  pressed(held);
  CHECK(!released(held));
}

TEST_CASE("walk: each push of the stick turns by 30° around the head") {
  for (const Tracking& to : {Tracking{}, tilted(1e5)}) {
    Walker walker(to);
    const Pose before = walker.head();
    const auto push = [&](double x) {
      walker.hand(kRight).stick = {x, 0.1};
      return walker.step().turned;
    };
    CHECK(push(1));
    CHECK(turnedBy(walker, before) == Approx(-glm::radians(30.0)).margin(1e-9));  // to the right
    CHECK(glm::distance(walker.head().position, before.position) < 1e-9 * to.unitsPerMetre + 1e-9);
    CHECK(!push(1));
    CHECK(!push(0.5));
    CHECK(!push(1));
    CHECK(!push(0.34));
    CHECK(!push(0.69));
    CHECK(push(0.71));
    CHECK(turnedBy(walker, before) == Approx(-glm::radians(60.0)).margin(1e-9));
    CHECK(push(-1));  // to the opposite side without a frame at rest
    CHECK(!push(0));
    CHECK(push(-1));
    CHECK(std::abs(turnedBy(walker, before)) < 1e-9);
    CHECK(!push(kNaN));
    CHECK(walker.state.fade == 0);
  }
}

TEST_CASE("walk: the right stick turns by the set angle, or the left one if it is the only hand") {
  Walker walker;
  walker.hand(kLeft).stick.x = 1;
  CHECK(!walker.step().turned);  // only the right stick turns
  walker.hand(kRight).active = false;
  CHECK(!walker.step().turned);  // held since before the stick's turn
  walker.hand(kLeft).stick.x = 0;
  walker.step();
  walker.hand(kLeft).stick.x = 1;
  CHECK(walker.step().turned);
  walker.hand(kRight).active = true;
  walker.hand(kRight).turn = -0.9;
  CHECK(!walker.step().turned);
  walker.hand(kRight).turn = 0;
  walker.step();
  const Pose before = walker.head();
  walker.hand(kRight).turn = -0.9;
  walker.settings.snapTurn = glm::radians(45.0);
  CHECK(walker.step().turned);
  CHECK(turnedBy(walker, before) == Approx(glm::radians(45.0)).margin(1e-9));
  walker.settings.snapTurn = 0;
  walker.hand(kRight).turn = 0.9;
  const Tracking tracking = walker.state.tracking;
  CHECK(!walker.step().turned);
  CHECK(same(walker.state.tracking, tracking));
}

TEST_CASE("walk: an untracked hand has no effect, nor do inputs held when tracking returns") {
  Walker walker;
  walker.settings.smoothMotion = true;
  const Tracking before = walker.state.tracking;
  walker.hand(kLeft).active = walker.hand(kRight).active = false;
  for (HandInput& hand : walker.input.hands) {
    hand.stick = {1, 1};
    hand.select = hand.menu = true;
  }
  const auto quiet = [&](const WalkOutput& output) {
    return !output.turned && !output.menuToggled && !output.showMarks && same(output.tracking, before);
  };
  for (int i = 0; i < 10; ++i) REQUIRE(quiet(walker.step()));
  walker.hand(kRight).active = true;
  for (int i = 0; i < 10; ++i) REQUIRE(quiet(walker.step()));
  walker.hand(kRight).stick.x = 0;
  walker.step();
  walker.hand(kRight).active = false;  // the only active hand
  walker.step();
  walker.hand(kRight).active = true;
  walker.hand(kRight).stick.x = 1;
  REQUIRE(quiet(walker.step()));
  // A single left hand turns with the stick axis that otherwise moves sideways.
  walker.hand(kRight).active = false;
  walker.hand(kLeft).active = true;
  walker.hand(kLeft).stick = {0, 0};
  walker.step();
  walker.hand(kLeft).active = false;
  walker.step();
  walker.hand(kLeft).active = true;
  walker.hand(kLeft).stick = {-1, 0};
  REQUIRE(quiet(walker.step()));
  walker.hand(kLeft).stick = {-0.6, 0};
  for (int i = 0; i < 10; ++i) REQUIRE(quiet(walker.step()));
}

TEST_CASE("walk: without a tracked head no input turns, moves or scales, also after tracking returns") {
  Walker walker(tilted(), 10);
  walker.settings.smoothMotion = true;
  const Tracking before = walker.state.tracking;
  for (const bool broken : {false, true}) {
    walker.input.head->position.x = kNaN;
    if (!broken) walker.input.head.reset();
    walker.hand(kRight).stick.x = 1;
    walker.hand(kLeft).stick.y = 1;
    walker.input.scale = 2;
    const WalkOutput output = walker.steps(20);
    CHECK(same(output.tracking, before));
    CHECK(output.vignette == 0);
    walker.hand(kLeft).stick.y = 0;
    walker.input.scale = 1;
    walker.input.head = Pose{{0.4, 1.7, -0.3}, {1, 0, 0, 0}};
    CHECK(!walker.step().turned);
    CHECK(same(walker.state.tracking, before));
    walker.hand(kRight).stick.x = 0;
    walker.step();
  }
}

TEST_CASE("walk: smooth motion is off by default, level and relative to the head's facing") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e4, 1e-2)}) {
    Walker walker(to);
    walker.input.head->rotation = glm::angleAxis(0.9, glm::dvec3(0, 1, 0)) * glm::angleAxis(-0.8, glm::dvec3(1, 0, 0));
    walker.hand(kLeft).stick = {0, 1};
    const Pose before = walker.head();
    walker.steps(90);
    CHECK(walker.head().position == before.position);
    walker.settings.smoothMotion = true;
    walker.steps(90);
    const glm::dvec3 gone = (walker.head().position - before.position) / to.unitsPerMetre;
    CHECK(glm::length(gone) == Approx(1.4).epsilon(1e-6));
    CHECK(angleBetween(gone, facingOf(before.rotation, walker.place.up)) < 1e-6);
    walker.hand(kLeft).stick = {1, 0};
    const glm::dvec3 from = walker.head().position;
    walker.steps(45);
    const glm::dvec3 right = glm::cross(facingOf(before.rotation, walker.place.up), walker.place.up);
    CHECK(angleBetween(walker.head().position - from, right) < 1e-6);
    // Diagonal motion is not faster, and a small deflection does not move.
    walker.hand(kLeft).stick = {-1, -1};
    const glm::dvec3 corner = walker.head().position;
    walker.steps(90);
    CHECK(glm::distance(walker.head().position, corner) == Approx(1.4 * to.unitsPerMetre).epsilon(1e-6));
    walker.hand(kLeft).stick = {0.1, 0.1};
    const Tracking rest = walker.state.tracking;
    walker.steps(90);
    CHECK(same(walker.state.tracking, rest));
    CHECK(walker.state.vignette == 0);
  }
}

TEST_CASE("walk: smooth motion slides along the bounds and does not depend on the frame rate") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e5, 0.1)}) {
    Walker walker(to, 1.5);
    walker.settings.smoothMotion = true;
    // The eyes' height does not matter: only horizontal distance counts.
    walker.input.head->position.y = 4;
    walker.hand(kLeft).stick = {0, 1};
    double most = 0;
    for (int i = 0; i < 400; ++i) {
      walker.step();
      most = std::max(most, walker.awayFrom(2));
    }
    CHECK(most == Approx(1.5).epsilon(1e-6));
    CHECK(walker.state.vignette < 0.05);  // standing still
    const double height = inTracking(walker.state.tracking, walker.place.spots[2].position).y;
    CHECK(height == Approx(1.6).margin(1e-6));
    walker.input.head->rotation = glm::angleAxis(-1.2, glm::dvec3(0, 1, 0));
    walker.steps(120);
    CHECK(walker.awayFrom(3) < walker.awayFrom(2));
    // Sliding stays level, however long it lasts.
    walker.input.head->rotation = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
    walker.steps(20000);
    CHECK(inTracking(walker.state.tracking, walker.place.spots[2].position).y == Approx(height).margin(1e-6));
  }
  glm::dvec3 at[2];
  for (const int rate : {0, 1}) {
    Walker walker(tilted(), 50);
    walker.settings.smoothMotion = true;
    walker.hand(kLeft).stick = {0.3, 0.9};
    walker.input.seconds = rate == 0 ? 1.0 / 120 : 1.0 / 30;
    walker.steps(rate == 0 ? 120 : 30);
    at[rate] = walker.head().position;
  }
  CHECK(glm::distance(at[0], at[1]) < 1e-9);
}

TEST_CASE("walk: smooth motion pauses during fades") {
  Walker walker;
  walker.settings.smoothMotion = true;
  walker.input.teleportTo = 1;
  walker.step();
  walker.input.teleportTo.reset();
  walker.hand(kLeft).stick = {0, 1};
  while (walker.state.fade > 0) {
    const WalkOutput output = walker.step();
    if (output.fade > 0 && walker.state.phase == FadePhase::in) REQUIRE(walker.awayFrom(1) < 1e-9);
    REQUIRE(output.vignette == 0);
  }
  walker.steps(10);
  CHECK(walker.awayFrom(1) > 0.1);
}

TEST_CASE("walk: the vignette follows the speed smoothly") {
  Walker walker;
  walker.settings.smoothMotion = true;
  walker.hand(kLeft).stick = {0, 1};
  double last = 0;
  for (int i = 0; i < 90; ++i) {
    const double vignette = walker.step().vignette;
    REQUIRE(vignette >= last);
    REQUIRE(vignette - last < 0.1);
    last = vignette;
  }
  CHECK(last == Approx(0.8).epsilon(0.01));
  walker.hand(kLeft).stick = {0, 0.5};
  const double half = walker.steps(90).vignette;
  CHECK(half > 0.2);
  CHECK(half < 0.5);
  walker.hand(kLeft).stick = {0, 0};
  for (int i = 0; i < 90; ++i) {
    const double vignette = walker.step().vignette;
    REQUIRE(vignette <= last);
    last = vignette;
  }
  CHECK(last == 0);
  walker.settings.vignette = 0;
  walker.hand(kLeft).stick = {0, 1};
  CHECK(walker.steps(50).vignette == 0);
}

TEST_CASE("walk: of several teleports during a fade the last one counts, through black") {
  Walker walker;
  const auto ask = [&](std::size_t spot) {
    walker.input.teleportTo = spot;
    const WalkOutput output = walker.step();
    walker.input.teleportTo.reset();
    return output;
  };
  ask(0);
  walker.steps(4);
  CHECK(walker.state.fade > 0);
  ask(4);
  int jumps = 0;
  while (jumps == 0) jumps += walker.step().jumped;
  CHECK(walker.awayFrom(4) < 1e-9);
  walker.steps(9);  // while fading in
  CHECK(walker.state.fade > 0);
  CHECK(walker.state.fade < 1);
  const double fade = walker.state.fade;
  CHECK(ask(1).fade > fade);
  CHECK(walker.awayFrom(4) < 1e-9);
  for (int i = 0; i < 60; ++i) {
    const WalkOutput output = walker.step();
    if (output.jumped) {
      ++jumps;
      REQUIRE(output.fade == 1);
    }
  }
  CHECK(jumps == 2);
  CHECK(walker.awayFrom(1) < 1e-9);
  CHECK(walker.state.fade == 0);
  ask(99);
  CHECK(walker.steps(20).fade == 0);
}

TEST_CASE("walk: the view stays black while requested, and teleports happen meanwhile") {
  Walker walker;
  walker.input.black = true;
  walker.steps(11);
  for (int i = 0; i < 100; ++i) REQUIRE(walker.step().fade == 1);
  walker.input.teleportTo = 4;
  CHECK(walker.step().jumped);
  walker.input.teleportTo.reset();
  CHECK(walker.steps(20).fade == 1);
  walker.input.black = false;
  CHECK(walker.steps(10).fade < 1);
  CHECK(walker.steps(10).fade == 0);
  CHECK(walker.awayFrom(4) < 1e-9);
}

TEST_CASE("walk: the scale changes at once within limits, and keeps the photographs' height above the floor") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e4, 1e-2)}) {
    Walker walker(to);
    walker.input.scale = 1.25;
    walker.step();
    CHECK(walker.state.tracking.unitsPerMetre == Approx(1.25 * to.unitsPerMetre));
    CHECK(walker.awayFrom(2) < 1e-6);
    CHECK(inTracking(walker.state.tracking, walker.place.spots[2].position).y == Approx(1.6).margin(1e-6));
    walker.steps(1000);
    CHECK(walker.state.tracking.unitsPerMetre == Approx(1e3 * to.unitsPerMetre));
    walker.input.scale = 0.01;
    walker.steps(1000);
    CHECK(walker.state.tracking.unitsPerMetre == Approx(1e-3 * to.unitsPerMetre));
    CHECK(walker.awayFrom(2) < 1e-3);
    const Tracking before = walker.state.tracking;
    for (const double none : {0.0, -2.0, kNaN, std::numeric_limits<double>::infinity()}) {
      walker.input.scale = none;
      walker.step();
    }
    CHECK(same(walker.state.tracking, before));
    CHECK(walker.state.fade == 0);
  }
}

TEST_CASE("walk: pressing the menu button of either hand toggles the menu") {
  Walker walker;
  int toggles = 0;
  const auto step = [&](bool left, bool right) {
    walker.hand(kLeft).menu = left;
    walker.hand(kRight).menu = right;
    toggles += walker.step().menuToggled;
  };
  step(true, false);
  CHECK(toggles == 1);
  step(true, false);
  step(false, false);
  CHECK(toggles == 1);
  step(false, true);
  CHECK(toggles == 2);
  walker.hand(kRight).active = false;
  step(false, true);
  walker.hand(kRight).active = true;
  step(false, true);
  CHECK(toggles == 2);  // the button was held when the hand became active
  step(false, false);
  step(true, true);
  CHECK(toggles == 2);  // both at once cancel out
  walker.state = startWalk(walker.place, walker.settings, 2);
  step(true, true);
  CHECK(toggles == 2);
}

TEST_CASE("walk: invalid or long time steps cause no jumps") {
  for (const double seconds : {0.0, kNaN, -1.0}) {
    Walker walker;
    walker.settings.smoothMotion = true;
    walker.input.seconds = seconds;
    walker.hand(kLeft).stick = {0, 1};
    walker.input.teleportTo = 0;
    const Tracking before = walker.state.tracking;
    CHECK(walker.steps(50).fade == 0);
    CHECK(same(walker.state.tracking, before));
    walker.input.teleportTo.reset();
    walker.input.seconds = kFrame;
    walker.steps(11);
    CHECK(walker.awayFrom(0) < 1e-9);
  }
  Walker walker;
  walker.settings.smoothMotion = true;
  walker.input.seconds = 10;
  walker.hand(kLeft).stick = {0, 1};
  const Pose before = walker.head();
  walker.step();
  CHECK(glm::distance(walker.head().position, before.position) <= 0.15);
  walker.hand(kLeft).stick = {0, 0};
  walker.input.teleportTo = 0;
  CHECK(!walker.step().jumped);
  walker.input.teleportTo.reset();
  const WalkOutput black = walker.step();
  CHECK(black.jumped);
  CHECK(black.fade == 1);
  CHECK(walker.step().fade > 0);
}

TEST_CASE("walk: invariants hold for random input") {
  for (const Tracking& to : {Tracking{}, tilted(), tilted(1e7, 1e3)}) {
    Walker walker(to, 2);
    AnyTracking any(23);
    const auto chance = [&](double share) { return any.between(0, 1) < share; };
    const auto value = [&] { return chance(0.05) ? kNaN : any.between(-1.2, 1.2); };
    int jumps = 0, turns = 0;
    for (int i = 0; i < 20000; ++i) {
      WalkInput& input = walker.input;
      input.seconds = chance(0.05) ? any.between(-1, 10) : kFrame;
      if (chance(0.02)) input.head = chance(0.3) ? std::optional<Pose>() : any.head();
      for (HandInput& hand : input.hands) {
        if (chance(0.02)) hand.active = !hand.active;
        if (chance(0.1)) hand.select = !hand.select;
        if (chance(0.05)) hand.menu = !hand.menu;
        if (chance(0.02)) hand.onPanel = !hand.onPanel;
        if (chance(0.2)) hand.aim = any.head();
        if (chance(0.01)) hand.aim.rotation.w = kNaN;
        if (chance(0.1)) hand.stick = {value(), value()};
        if (chance(0.05)) hand.turn = value();
      }
      input.teleportTo = chance(0.01) ? std::optional<std::size_t>(std::size_t(any.between(0, 8))) : std::nullopt;
      input.scale = chance(0.01) ? any.between(0.5, 2) : 1;
      input.black = chance(0.01);
      walker.settings.smoothMotion = i % 1000 > 500;
      const Tracking before = walker.state.tracking;
      const WalkOutput output = walker.step();
      REQUIRE(output.fade >= 0);
      REQUIRE(output.fade <= 1);
      REQUIRE(output.vignette >= 0);
      REQUIRE(output.vignette <= 1);
      if (output.jumped) REQUIRE(output.fade == 1);
      REQUIRE(output.jumped == output.arrived.has_value());
      REQUIRE(same(output.tracking, walker.state.tracking));
      REQUIRE(std::isfinite(output.tracking.origin.x));
      REQUIRE(glm::length(output.tracking.rotation) == Approx(1).margin(1e-12));
      REQUIRE(angleBetween(upInWorld(output.tracking), walker.place.up) < 1e-9);
      if (!input.head) REQUIRE(same(output.tracking, before));
      const bool asked = output.jumped || output.turned || walker.settings.smoothMotion || input.scale != 1;
      if (!asked) REQUIRE(same(output.tracking, before));
      for (const HandOutput& hand : output.hands) {
        if (hand.pointed) REQUIRE(hand.aiming);
        REQUIRE((!hand.aiming || !hand.panelSelect));
      }
      jumps += output.jumped;
      turns += output.turned;
    }
    CHECK(jumps > 50);
    CHECK(turns > 50);
  }
}
