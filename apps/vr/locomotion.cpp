// SPDX-License-Identifier: Apache-2.0
#include "vr/locomotion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace ibr::app {
namespace {

using Select = WalkState::HandState::Select;

constexpr double kLongestStep = 0.1;                // s
constexpr double kTurnsBeyond = 0.7, kRest = 0.35;  // of the stick's way
constexpr double kDeadZone = 0.15;                  // of the stick's way
constexpr double kVignetteSeconds = 0.12;           // in which it comes nearer to what is wanted by 63 %
constexpr double kLeastVignette = 1e-3;
constexpr double kScaleRange = 1e3;
constexpr double kNearMetres = 0.3;  // nothing nearer to a hand is pointed at

bool isFinite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::optional<Pose> soundPose(const Pose& pose) {
  const glm::dquat& q = pose.rotation;
  const double length = glm::length(q);
  if (!isFinite(pose.position) || !std::isfinite(length) || !(length > 0.1)) return std::nullopt;
  return Pose{pose.position, q / length};
}

double sound(double value) {
  return std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : 0;
}

// What a step goes by: input with all that is not finite taken out.
struct Given {
  double seconds = 0;
  std::optional<Pose> head;
  std::array<HandInput, 2> hands;
};

Given given(const WalkInput& input) {
  Given given;
  given.seconds = input.seconds > 0 ? std::min(input.seconds, kLongestStep) : 0;
  if (input.head) given.head = soundPose(*input.head);
  for (std::size_t i = 0; i < 2; ++i) {
    HandInput& hand = given.hands[i] = input.hands[i];
    const auto aim = soundPose(hand.aim);
    if (!aim) hand.active = false;
    if (!hand.active) hand = {};
    if (hand.active) hand.aim = *aim;
    hand.stick = {sound(hand.stick.x), sound(hand.stick.y)};
    hand.turn = sound(hand.turn);
  }
  return given;
}

double photographHeight(const WalkState& state, const WalkSettings& settings) {
  return settings.photographHeightMetres * state.tracking.unitsPerMetre;
}

void aim(WalkState& state, const WalkPlace& place, const WalkSettings& settings, const HandInput& hand,
         WalkState::HandState& memory) {
  PointingSettings pointing;
  pointing.leastDistance = kNearMetres * state.tracking.unitsPerMetre;
  memory.pointed = pointedSpot(place.spots, rayOf(inWorld(state.tracking, hand.aim)), place.up,
                               photographHeight(state, settings), memory.pointed, pointing);
}

// What select does. Gives the spot that the hand let go at.
std::optional<std::size_t> selected(WalkState::HandState& memory, const HandInput& hand, bool headThere) {
  if (!hand.active) {
    memory = {};
    return std::nullopt;
  }
  if (hand.select) {
    if (memory.select == Select::free) memory.select = hand.onPanel ? Select::panel : Select::aiming;
    if (memory.select == Select::aiming && hand.onPanel) memory.pointed.reset();
    return std::nullopt;
  }
  const bool goes = memory.select == Select::aiming && !hand.onPanel && headThere;
  memory.select = Select::free;
  const auto spot = std::exchange(memory.pointed, std::nullopt);
  return goes ? spot : std::nullopt;
}

bool menuPressed(WalkState::HandState& memory, const HandInput& hand) {
  return hand.active && hand.menu && std::exchange(memory.menuFree, false) ? true
                                                                           : (memory.menuFree = !hand.menu, false);
}

const HandInput& turningHand(const Given& input) {
  return input.hands[input.hands[kRight].active || !input.hands[kLeft].active ? kRight : kLeft];
}

// +1 to the right, −1 to the left, 0: none now.
int stickTurn(WalkState& state, const Given& input) {
  const HandInput& hand = turningHand(input);
  const double x = std::abs(hand.turn) > std::abs(hand.stick.x) ? hand.turn : hand.stick.x;
  const int side = x > 0 ? 1 : -1;
  if (std::abs(x) < kRest) state.turnedTo = 0;
  if (!(std::abs(x) > kTurnsBeyond) || state.turnedTo == side) return 0;
  state.turnedTo = side;
  return side;
}

// Tracking space, of length up to 1: where the left stick leads.
glm::dvec3 stickMotion(const Given& input, const Pose& head) {
  const glm::dvec2 stick = input.hands[kLeft].stick;
  // A hand that is alone turns with x.
  const double x = input.hands[kRight].active ? stick.x : 0, length = std::hypot(x, stick.y);
  if (!(length > kDeadZone)) return glm::dvec3(0);
  const glm::dvec3 ahead = facingOf(head.rotation), right = glm::cross(ahead, glm::dvec3(0, 1, 0));
  const double speed = (std::min(length, 1.0) - kDeadZone) / (1 - kDeadZone);
  return (ahead * stick.y + right * x) * (speed / length);
}

// Moves the tracking and gives the share of the full speed that was gone with.
double move(WalkState& state, const WalkPlace& place, const WalkSettings& settings, const Given& input) {
  const glm::dvec3 motion = stickMotion(input, *input.head);
  if (motion == glm::dvec3(0) || !(input.seconds > 0)) return glm::length(motion);
  const glm::dvec3 eyes = inWorld(state.tracking, input.head->position);
  const glm::dvec3 step =
      inWorld(state.tracking, motion * (settings.metresPerSecond * input.seconds)) - state.tracking.origin;
  const glm::dvec3 from = eyes - glm::dot(eyes, place.up) * place.up;
  const glm::dvec3 gone = keptWithin(place.level, from, from + step) - from;
  if (!isFinite(gone)) return 0;
  state.tracking.origin += gone - glm::dot(gone, place.up) * place.up;
  return std::min(1.0, glm::length(gone) / glm::length(step)) * glm::length(motion);
}

void followVignette(WalkState& state, double wanted, double seconds) {
  state.vignette = wanted + (state.vignette - wanted) * std::exp(-seconds / kVignetteSeconds);
  if (wanted == 0 && state.vignette < kLeastVignette) state.vignette = 0;
}

void rescale(WalkState& state, const WalkSettings& settings, const Pose& head, double factor) {
  if (factor == 1 || !std::isfinite(factor) || !(factor > 0)) return;
  const double scale = std::clamp(state.tracking.unitsPerMetre * factor, state.firstUnitsPerMetre / kScaleRange,
                                  state.firstUnitsPerMetre * kScaleRange);
  state.tracking = scaled(state.tracking, head, settings.photographHeightMetres, scale);
}

void goTo(WalkState& state, const WalkPlace& place, std::size_t spot) {
  if (spot >= place.spots.size()) return;
  state.wanted = spot;
  state.wantedFacing.reset();
}

// The head stands at the wanted spot. Only while all is black.
void jump(WalkState& state, const WalkPlace& place, const WalkSettings& settings, const Pose& head,
          WalkOutput& output) {
  if (!state.wanted) return;
  const std::size_t spot = *std::exchange(state.wanted, std::nullopt);
  const auto facing = std::exchange(state.wantedFacing, std::nullopt);
  if (spot >= place.spots.size()) return;
  state.tracking = standAt(state.tracking, head, place.spots[spot], settings.photographHeightMetres, facing);
  output.jumped = true;
  output.arrived = spot;
}

void fade(WalkState& state, bool black, bool headThere, double seconds) {
  if ((state.wanted || black) && state.fade < 1) state.phase = FadePhase::out;
  if (state.phase == FadePhase::out) state.fade = std::min(1.0, state.fade + seconds / kFadeOutSeconds);
  if (state.phase == FadePhase::in && !state.wanted && !black && headThere)
    state.fade = std::max(0.0, state.fade - seconds / kFadeInSeconds);
  if (state.phase == FadePhase::in && state.fade == 0) state.phase = FadePhase::clear;
  if (state.phase == FadePhase::out && state.fade == 1) state.phase = FadePhase::in;
}

// The last head's place and facing in the world become this head's.
void realign(WalkState& state, const Pose& head) {
  if (!std::exchange(state.realign, false) || !state.lastHead) return;
  const Pose last = inWorld(state.tracking, *state.lastHead);
  const glm::dvec3 ground = inWorld(state.tracking, {state.lastHead->position.x, 0, state.lastHead->position.z});
  const glm::dvec3 facing = facingOf(last.rotation, upInWorld(state.tracking));
  state.tracking = stoodOn(turnedTo(state.tracking, head, facing), head, ground);
}

}  // namespace

WalkPlace walkPlace(std::vector<Spot> spots, glm::dvec3 up, double unitsPerMetre, RoamingBounds bounds) {
  for (glm::dvec3& place : bounds.places) place -= glm::dot(place, up) * up;
  return {std::move(spots), up, std::move(bounds), unitsPerMetre};
}

WalkState startWalk(const WalkPlace& place, const WalkSettings& settings, std::optional<std::size_t> spot) {
  WalkState state;
  state.tracking = levelTracking(place.up, place.unitsPerMetre);
  state.firstUnitsPerMetre = place.unitsPerMetre;
  if (!spot || *spot >= place.spots.size()) return state;
  state.wanted = spot;
  state.wantedFacing = place.spots[*spot].facing;
  state.tracking =
      standAt(state.tracking, {}, place.spots[*spot], settings.photographHeightMetres, place.spots[*spot].facing);
  return state;
}

WalkOutput step(WalkState& state, const WalkPlace& place, const WalkSettings& settings, const WalkInput& input) {
  const Given now = given(input);
  WalkOutput output;
  if (now.head) realign(state, *now.head);
  for (std::size_t i = 0; i < 2; ++i) {
    WalkState::HandState& memory = state.hands[i];
    const HandInput& hand = now.hands[i];
    if (menuPressed(memory, hand)) output.menuToggled = !output.menuToggled;
    if (const auto spot = selected(memory, hand, now.head.has_value())) goTo(state, place, *spot);
  }
  if (input.goTo) goTo(state, place, *input.goTo);
  const int turn = stickTurn(state, now);
  double speed = 0;
  if (now.head) {
    if (turn != 0 && settings.snapTurn != 0 && std::isfinite(settings.snapTurn)) {
      state.tracking = turned(state.tracking, *now.head, -turn * settings.snapTurn);
      output.turned = true;
    }
    if (settings.smoothMotion && state.phase == FadePhase::clear) speed = move(state, place, settings, now);
    rescale(state, settings, *now.head, input.scale);
  }
  fade(state, input.black, now.head.has_value(), now.seconds);
  if (now.head && state.fade == 1) jump(state, place, settings, *now.head, output);
  followVignette(state, speed * settings.vignette, now.seconds);
  for (std::size_t i = 0; i < 2; ++i) {
    WalkState::HandState& memory = state.hands[i];
    const bool aiming = memory.select == Select::aiming && !now.hands[i].onPanel && now.head;
    if (aiming) aim(state, place, settings, now.hands[i], memory);
    output.hands[i] = {aiming, memory.pointed, memory.select == Select::panel};
    output.showMarks = output.showMarks || aiming;
  }
  if (now.head) state.lastHead = now.head;
  output.tracking = state.tracking;
  output.fade = state.fade;
  output.vignette = state.vignette;
  return output;
}

void recentred(WalkState& state, const std::optional<Pose>& newInOld) {
  const auto sound = newInOld ? soundPose(*newInOld) : std::nullopt;
  if (!sound) {
    state.realign = true;
    return;
  }
  state.tracking = recentred(state.tracking, *sound);
  if (state.lastHead) {
    const glm::dquat back = glm::conjugate(sound->rotation);
    state.lastHead = Pose{back * (state.lastHead->position - sound->position), back * state.lastHead->rotation};
  }
}

}  // namespace ibr::app
