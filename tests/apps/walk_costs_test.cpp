// SPDX-License-Identifier: Apache-2.0
// Work of a frame besides drawing: motion, pointing, marks of spots and the governor allocate nothing.
#include <catch2/catch.hpp>
#include <cmath>

#include "shared/camera/navigation.h"
#include "support/allocation_count.h"
#include "vr/walk/governor.h"
#include "vr/walk/locomotion.h"
#include "vr/walk/shapes.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

constexpr int kSide = 60;  // photographs along a side of the grid

RoamingBounds gridBounds() {
  RoamingBounds bounds{{}, {}, 0.5};
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    bounds.positions.emplace_back(i % kSide, 1.6, i / kSide);
    if (i % kSide > 0) bounds.neighbours.emplace_back(i - 1, i);
  }
  return bounds;
}

}  // namespace

TEST_CASE("moving within the bounds of a scene allocates nothing") {
  RoamingBounds bounds = gridBounds();
  addIndex(bounds);
  Navigation state;
  state.pose.position = bounds.positions[kSide + 1];
  const std::size_t before = allocationCount();
  for (int i = 0; i < 500; ++i)
    navigate(state, {.seconds = 0.02, .move = {std::sin(0.01 * i), 0.1, -1}, .look = {3, 0}}, &bounds);
  CHECK(allocationCount() == before);
  CHECK(distanceTo(bounds, state.pose.position) <= 0.5 + 1e-9);
}

TEST_CASE("walking, pointing, marks of spots and the governor allocate nothing") {
  RoamingBounds bounds = gridBounds();
  std::vector<Spot> spots;
  for (const glm::dvec3& place : bounds.positions) spots.push_back({place, {0, 0, -1}, {0}});
  const WalkScene place = makeWalkScene(std::move(spots), {0, 1, 0}, 1, std::move(bounds));
  WalkSettings settings;
  settings.smoothMotion = true;
  WalkState state = startWalk(place, settings, kSide * kSide / 2);
  WalkInput input{.seconds = 1.0 / 90, .head = Pose{{0, 1.7, 0}, {1, 0, 0, 0}}};
  for (HandInput& hand : input.hands) hand = {.active = true, .aim = {{0.3, 1.2, 0}, {1, 0, 0, 0}}};
  GovernorState governor = startGovernor(ladder({}));
  Shapes shapes;
  std::size_t allocations = 0;
  int aimed = 0;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t before = allocationCount();
    for (int i = 0; i < 200; ++i) {
      input.hands[kLeft].stick = {0.2, 0.9};
      input.hands[kRight].select = i % 100 > 10;  // a release teleports
      const WalkOutput output = step(state, place, settings, input);
      const std::optional<std::size_t> pointed = output.hands[kRight].pointed;
      shapes.inSpace.clear();
      shapes.onView.clear();
      if (output.showMarks) addMarks(shapes, place.spots, output.tracking, *input.head, 1.6, pointed);
      addVignette(shapes, output.vignette);
      aimed += pointed.has_value();
      govern(governor, {.workMs = 5, .periodMs = 11});
      nearestSpot(place.spots, output.tracking.origin, place.up);
    }
    allocations = allocationCount() - before;
  }
  CHECK(allocations == 0);
  CHECK(aimed > 100);
}
