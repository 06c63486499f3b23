// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/hand_input.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

namespace ibr::app {
namespace {

using Select = WalkState::HandState::Select;

constexpr double kMaxStepSeconds = 0.1;                         // s
constexpr double kTurnThreshold = 0.7, kRearmThreshold = 0.35;  // of the stick's range: turns above, armed again below

double sound(double value) {
  return std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : 0;
}

HandInput sanitisedHand(HandInput hand) {
  const auto aim = normalisedIfFinite(hand.aim);
  if (!hand.active || !aim) return {};
  hand.aim = *aim;
  hand.stick = {sound(hand.stick.x), sound(hand.stick.y)};
  hand.turn = sound(hand.turn);
  return hand;
}

}  // namespace

std::optional<Pose> normalisedIfFinite(const Pose& pose) {
  const double length = glm::length(pose.rotation);
  const glm::dvec3& at = pose.position;
  if (!std::isfinite(at.x + at.y + at.z) || !std::isfinite(length) || !(length > 0.1)) return std::nullopt;
  return Pose{at, pose.rotation / length};
}

SanitisedInput sanitised(const WalkInput& input) {
  SanitisedInput sanitised;
  sanitised.seconds = input.seconds > 0 ? std::min(input.seconds, kMaxStepSeconds) : 0;
  if (input.head) sanitised.head = normalisedIfFinite(*input.head);
  std::ranges::transform(input.hands, sanitised.hands.begin(), sanitisedHand);
  return sanitised;
}

std::optional<std::size_t> selected(WalkState::HandState& memory, const HandInput& hand, bool headTracked) {
  if (!hand.active) {
    memory.select = Select::unknown;
    memory.pointed.reset();
    return std::nullopt;
  }
  if (hand.select) {
    if (memory.select == Select::free) memory.select = hand.onPanel ? Select::panel : Select::aiming;
    return std::nullopt;
  }
  const bool goes = memory.select == Select::aiming && !hand.onPanel && headTracked;
  memory.select = Select::free;
  const auto spot = std::exchange(memory.pointed, std::nullopt);
  return goes ? spot : std::nullopt;
}

bool menuPressed(WalkState::HandState& memory, const HandInput& hand) {
  const bool pressed = hand.menu && memory.menuReleased;
  memory.menuReleased = hand.active && !hand.menu;
  return pressed;
}

int stickTurn(WalkState& state, const std::array<HandInput, 2>& hands) {
  const std::size_t turning = hands[kRight].active ? kRight : kLeft;
  const HandInput& hand = hands[turning];
  if (!hand.active || turning != state.turningHand) state.turnedTo = WalkState::kUnseen;
  state.turningHand = turning;
  if (!hand.active) return 0;
  const double x = std::abs(hand.turn) > std::abs(hand.stick.x) ? hand.turn : hand.stick.x;
  if (std::abs(x) < kRearmThreshold) state.turnedTo = 0;
  const int side = x > 0 ? 1 : -1;
  if (!(std::abs(x) > kTurnThreshold) || state.turnedTo == WalkState::kUnseen || state.turnedTo == side) return 0;
  state.turnedTo = side;
  return side;
}

}  // namespace ibr::app
