// SPDX-License-Identifier: Apache-2.0
// A simulated person with a head and two hands who walks through a row of spots, frame by frame.
#pragma once

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "any_tracking.h"
#include "vr/walk/locomotion.h"

namespace ibr::test {

inline constexpr double kFrame = 1.0 / 90;

struct Walker {
  app::WalkScene place;
  app::WalkSettings settings;
  app::WalkState state;
  app::WalkInput input;

  /// Spots 3 m apart along the world's x axis, which `to` tilts, facing −z. The person stands at the middle spot, faded
  /// in, with empty hands.
  explicit Walker(const app::Tracking& to = {}, double radius = 0, int spots = 5) {
    input.seconds = kFrame;
    input.head = Pose{{0.4, 1.7, -0.3}, {1, 0, 0, 0}};
    for (app::HandInput& hand : input.hands) {
      hand.active = true;
      hand.aim = {{0.6, 1.2, -0.5}, glm::angleAxis(glm::half_pi<double>(), glm::dvec3(1, 0, 0))};  // up
    }
    std::vector<app::Spot> row;
    app::RoamingBounds bounds{{}, {}, radius * to.unitsPerMetre};
    for (int i = 0; i < spots; ++i)
      row.push_back({inWorld(to, glm::dvec3(3 * (i - spots / 2), 1.6, 0)), to.rotation * glm::dvec3(0, 0, -1), {}});
    if (radius > 0)
      for (const app::Spot& spot : row) bounds.positions.push_back(spot.position);
    for (std::uint32_t i = 0; radius > 0 && i + 1 < row.size(); ++i) bounds.neighbours.emplace_back(i, i + 1);
    place = app::makeWalkScene(row, upInWorld(to), to.unitsPerMetre, bounds);
    state = app::startWalk(place, settings, std::size_t(spots / 2));
    steps(40);
  }

  app::WalkOutput step() { return app::step(state, place, settings, input); }
  app::WalkOutput steps(int count) {
    app::WalkOutput output;
    for (int i = 0; i < count; ++i) output = step();
    return output;
  }

  Pose head() const { return inWorld(state.tracking, *input.head); }
  app::HandInput& hand(app::Hand hand) { return input.hands[hand]; }

  /// Points a hand from its own position at a point of the world.
  void pointAt(app::Hand which, glm::dvec3 world) {
    Pose& aim = hand(which).aim;
    const glm::dvec3 to = glm::normalize(inTracking(state.tracking, world) - aim.position);
    aim.rotation = glm::normalize(glm::dquat(1 - to.z, glm::cross(glm::dvec3(0, 0, -1), to)));
  }

  /// Horizontal distance of the head from a spot, m.
  double awayFrom(std::size_t spot) const {
    const glm::dvec3 off = inTracking(state.tracking, place.spots[spot].position) - input.head->position;
    return std::hypot(off.x, off.z);
  }
};

inline bool same(const app::Tracking& a, const app::Tracking& b) {
  return a.origin == b.origin && a.rotation == b.rotation && a.unitsPerMetre == b.unitsPerMetre;
}

}  // namespace ibr::test
