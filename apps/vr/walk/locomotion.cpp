// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/locomotion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "vr/walk/hand_input.h"

namespace ibr::app {
namespace {

using Select = WalkState::HandState::Select;

constexpr double kDeadZone = 0.15;         // of the stick's range
constexpr double kVignetteSeconds = 0.12;  // time constant: reaches 63 % of the target
constexpr double kMinVignette = 1e-3;
constexpr double kScaleRange = 1e3;
constexpr double kNearMetres = 0.3;  // m, minimum distance from the hand of things to point at

// Direction and speed of the left stick in tracking space, of length up to 1.
glm::dvec3 stickMotion(const SanitisedInput& input, const Pose& head) {
  const glm::dvec2 stick = input.hands[kLeft].stick;
  // A single tracked hand uses x to turn.
  const double x = input.hands[kRight].active ? stick.x : 0, length = std::hypot(x, stick.y);
  if (!(length > kDeadZone)) return glm::dvec3(0);
  const glm::dvec3 ahead = facingOf(head.rotation), right = glm::cross(ahead, glm::dvec3(0, 1, 0));
  const double speed = (std::min(length, 1.0) - kDeadZone) / (1 - kDeadZone);
  return (ahead * stick.y + right * x) * (speed / length);
}

// Moves the tracking. Returns the share of the full speed that was moved at.
double move(WalkState& state, const WalkScene& place, const WalkSettings& settings, const SanitisedInput& input) {
  const glm::dvec3 motion = stickMotion(input, *input.head);
  if (motion == glm::dvec3(0) || !(input.seconds > 0)) return glm::length(motion);
  const glm::dvec3 eyes = inWorld(state.tracking, input.head->position);
  const Tracking& tracking = state.tracking;
  const glm::dvec3 step =
      tracking.rotation * (motion * (settings.metresPerSecond * input.seconds * tracking.unitsPerMetre));
  const glm::dvec3 from = eyes - glm::dot(eyes, place.up) * place.up, to = from + step;
  const glm::dvec3 gone = clampedToBounds(place.level, from, to) - from;
  state.tracking.origin += gone;
  return std::min(1.0, glm::length(gone) / glm::length(step)) * glm::length(motion);
}

bool turnBy(WalkState& state, const Pose& head, double radians) {
  if (radians == 0) return false;
  state.tracking = turned(state.tracking, head, radians);
  return true;
}

void followVignette(WalkState& state, double wanted, double seconds) {
  state.vignette = wanted + (state.vignette - wanted) * std::exp(-seconds / kVignetteSeconds);
  if (wanted == 0 && state.vignette < kMinVignette) state.vignette = 0;
}

void rescale(WalkState& state, const WalkSettings& settings, const Pose& head, double factor) {
  if (factor == 1 || !std::isfinite(factor) || !(factor > 0)) return;
  const double scale = std::clamp(state.tracking.unitsPerMetre * factor, state.initialUnitsPerMetre / kScaleRange,
                                  state.initialUnitsPerMetre * kScaleRange);
  state.tracking = scaled(state.tracking, head, settings.photographHeightMetres, scale);
}

void teleportTo(WalkState& state, const WalkScene& place, std::size_t spot) {
  if (spot >= place.spots.size()) return;
  state.wanted = spot;
}

// Puts the head at the wanted spot. Only while the view is black.
void jump(WalkState& state, const WalkScene& place, const WalkSettings& settings, const Pose& head,
          WalkOutput& output) {
  if (!state.wanted) return;
  const std::size_t spot = *std::exchange(state.wanted, std::nullopt);
  if (spot >= place.spots.size()) return;
  const Spot& to = place.spots[spot];
  const auto facing = std::exchange(state.faceSpotOnJump, false) ? std::optional(to.facing) : std::nullopt;
  state.tracking = standAt(state.tracking, head, to, settings.photographHeightMetres, facing);
  output.jumped = true;
  output.arrived = spot;
}

void fade(WalkState& state, bool black, double seconds) {
  if ((state.wanted || black) && state.fade < 1) state.phase = FadePhase::out;
  if (state.phase == FadePhase::out) state.fade = std::min(1.0, state.fade + seconds / kFadeOutSeconds);
  if (state.phase == FadePhase::in && !state.wanted && !black)
    state.fade = std::max(0.0, state.fade - seconds / kFadeInSeconds);
  if (state.phase == FadePhase::in && state.fade == 0) state.phase = FadePhase::clear;
  if (state.phase == FadePhase::out && state.fade == 1) state.phase = FadePhase::in;
}

// Handles presses and releases of both hands.
void listen(WalkState& state, const WalkScene& place, const SanitisedInput& input, WalkOutput& output) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (menuPressed(state.hands[i], input.hands[i])) output.menuToggled = !output.menuToggled;
    if (const auto spot = selected(state.hands[i], input.hands[i], input.head.has_value()))
      teleportTo(state, place, *spot);
  }
}

// Finds the spots that aiming hands point at, for this frame's image and for a release in the next frame.
void point(WalkState& state, const WalkScene& place, const WalkSettings& settings, const SanitisedInput& input,
           WalkOutput& output) {
  PointingSettings pointing;
  pointing.minDistance = kNearMetres * state.tracking.unitsPerMetre;
  const double height = settings.photographHeightMetres * state.tracking.unitsPerMetre;
  for (std::size_t i = 0; i < 2; ++i) {
    WalkState::HandState& memory = state.hands[i];
    HandOutput& hand = output.hands[i];
    hand.panelSelect = memory.select == Select::panel;
    hand.aiming = memory.select == Select::aiming && !input.hands[i].onPanel && input.head;
    if (!hand.aiming) continue;
    const Ray ray = rayOf(inWorld(state.tracking, input.hands[i].aim));
    hand.pointed = memory.pointed = pointedSpot(place.spots, ray, place.up, height, memory.pointed, pointing);
    output.showMarks = true;
  }
}

// Gives the current head the world position and facing of the last tracked head.
void realign(WalkState& state, const Pose& head) {
  if (!std::exchange(state.realign, false) || !state.lastHead) return;
  const Pose last = inWorld(state.tracking, *state.lastHead);
  const glm::dvec3 ground = inWorld(state.tracking, {state.lastHead->position.x, 0, state.lastHead->position.z});
  const glm::dvec3 facing = facingOf(last.rotation, upInWorld(state.tracking));
  state.tracking = stoodOn(turnedTo(state.tracking, head, facing), head, ground);
}

}  // namespace

WalkScene makeWalkScene(std::vector<Spot> spots, glm::dvec3 up, double unitsPerMetre, RoamingBounds bounds) {
  for (glm::dvec3& place : bounds.positions) place -= glm::dot(place, up) * up;
  addIndex(bounds);
  return {Spots(std::move(spots)), up, std::move(bounds), unitsPerMetre};
}

WalkState startWalk(const WalkScene& place, const WalkSettings& settings, std::optional<std::size_t> spot) {
  WalkState state;
  state.tracking = levelTracking(place.up, place.unitsPerMetre);
  state.initialUnitsPerMetre = place.unitsPerMetre;
  if (!spot || *spot >= place.spots.size()) return state;
  state.wanted = spot;
  state.tracking =
      standAt(state.tracking, {}, place.spots[*spot], settings.photographHeightMetres, place.spots[*spot].facing);
  return state;
}

WalkOutput step(WalkState& state, const WalkScene& place, const WalkSettings& settings, const WalkInput& input) {
  const SanitisedInput now = sanitised(input);
  WalkOutput output;
  if (now.head) realign(state, *now.head);
  listen(state, place, now, output);
  if (input.teleportTo) teleportTo(state, place, *input.teleportTo);
  const int turn = stickTurn(state, now.hands);
  double speed = 0;
  if (now.head) {
    output.turned = turnBy(state, *now.head, -turn * settings.snapTurn);
    if (settings.smoothMotion && state.phase == FadePhase::clear) speed = move(state, place, settings, now);
    rescale(state, settings, *now.head, input.scale);
  }
  fade(state, input.black, now.seconds);
  if (now.head && state.fade == 1) jump(state, place, settings, *now.head, output);
  followVignette(state, speed * std::clamp(settings.vignette, 0.0, 1.0), now.seconds);
  point(state, place, settings, now, output);
  if (now.head) state.lastHead = now.head;
  output.tracking = state.tracking;
  output.fade = state.fade;
  output.vignette = state.vignette;
  return output;
}

void recentred(WalkState& state, const std::optional<Pose>& newInOld) {
  const auto sound = newInOld ? normalisedIfFinite(*newInOld) : std::nullopt;
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
