// SPDX-License-Identifier: Apache-2.0
// How a person moves through a place: by teleport to photographed spots, turns in steps, and smoothly if they ask.
//
// A pure state machine: no clock, no OpenXR. Nothing moves that nobody asked for: without input the tracking stays as
// it is to the last bit. Without a head nothing moves at all. What is not finite in a step's input counts as not given.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "shared/camera/roaming.h"
#include "vr/walk/spots.h"
#include "vr/walk/tracking.h"

namespace ibr::app {

/// What is walked through; made by walkPlace.
struct WalkPlace {
  std::vector<Spot> spots;
  glm::dvec3 up{0, 1, 0};    // unit, world
  RoamingBounds level;       // where eyes may go, projected along `up` through the world's origin; no places: anywhere
  double unitsPerMetre = 1;  // to begin with, > 0
};

/// `bounds` as of any camera (roaming.h); smooth motion is level, so only its horizontal part counts.
WalkPlace walkPlace(std::vector<Spot> spots, glm::dvec3 up, double unitsPerMetre, RoamingBounds bounds);

/// All finite.
struct WalkSettings {
  double snapTurn = std::numbers::pi / 6;  // radians of one turn; 0: the stick does not turn
  bool smoothMotion = false;
  double metresPerSecond = 1.4;         // with the stick all the way
  double vignette = 0.8;                // strength at full speed, 0 to 1
  double photographHeightMetres = 1.6;  // of the photographs above the ground
};

/// One hand since the last step.
struct HandInput {
  bool active = false;
  Pose aim;               // tracking space, points along −z
  bool select = false;    // held
  bool menu = false;      // held
  glm::dvec2 stick{0.0};  // −1 to 1, x right, y ahead
  double turn = 0;        // −1 to 1, right: of controllers that turn by something else than a stick
  bool onPanel = false;   // its ray meets the menu panel, which then takes what is selected
};

enum Hand : std::size_t { kLeft = 0, kRight = 1 };

struct WalkInput {
  double seconds = 0;        // since the last step; more than a tenth counts as one
  std::optional<Pose> head;  // tracking space, between the eyes; none: it is not tracked
  std::array<HandInput, 2> hands;
  std::optional<std::size_t> goTo;  // a spot chosen otherwise (the map): as if it had been pointed at
  double scale = 1;                 // times as many world units a metre; > 0
  bool black = false;               // fades out and stays so until it is false: for a change of the place
};

enum class FadePhase : std::uint8_t { clear, out, in };

/// What holds from step to step. Made by startWalk.
struct WalkState {
  static constexpr int kUnseen = 2;  // of turnedTo: it may have been pushed before anybody looked
  struct HandState {
    enum class Select : std::uint8_t { unknown, free, aiming, panel };
    Select select = Select::unknown;  // unknown: it was held before it was first seen
    bool menuFree = false;            // has been seen not held
    std::optional<std::size_t> pointed;
  };
  Tracking tracking;
  double firstUnitsPerMetre = 1;
  std::array<HandState, 2> hands;
  std::size_t turningHand = kRight;
  int turnedTo = kUnseen;  // side of its stick that has turned, 0: it has been seen in the middle
  FadePhase phase = FadePhase::in;
  double fade = 1;                    // 0 to 1
  double vignette = 0;                // 0 to 1
  std::optional<std::size_t> wanted;  // spot to go to when all is black
  bool facesSpot = true;              // until one has been stood at: as its photographs do
  std::optional<Pose> lastHead;       // tracking space
  bool realign = false;               // the tracking space moved by nobody knows what
};

struct HandOutput {
  bool aiming = false;                 // shows its ray and the marks of spots
  std::optional<std::size_t> pointed;  // spot
  bool panelSelect = false;            // select is held and is the panel's
};

struct WalkOutput {
  Tracking tracking;    // for this frame
  double fade = 0;      // to be drawn over this frame: 1 is black
  double vignette = 0;  // strength
  bool jumped = false;  // the head is elsewhere than in the frame before; only while fade is 1
  bool turned = false;  // by a step
  bool menuToggled = false;
  bool showMarks = false;  // some hand is aiming
  std::array<HandOutput, 2> hands;
  std::optional<std::size_t> arrived;  // the spot, in the frame that jumped
};

inline constexpr double kFadeOutSeconds = 0.12, kFadeInSeconds = 0.2;

/// Black, about to stand at a spot (none, or out of range: at the world's origin); it comes in when a head is there.
/// The first spot that is stood at is faced as its photographs do, at others one faces as before.
WalkState startWalk(const WalkPlace& place, const WalkSettings& settings, std::optional<std::size_t> spot);

/// Moves on by one frame.
///
/// select: while it is held a hand aims; let go, the person goes to the spot that was pointed at. What was pressed on
///   the panel is the panel's until it is let go; what is let go there, or by a hand or head that is not tracked, goes
///   nowhere. A press that was begun before this state was made is passed over.
/// stick: x of the right hand, or of the left where it is alone, turns once for each time beyond 0.7; it counts again
///   after it was within 0.35, as it must have been seen at first. With smoothMotion the left hand's moves along where
///   the head faces, level, within the place's bounds.
/// goTo, or another teleport, during a fade: the last one asked for is gone to, through black.
/// scale: at once, the photographs' height kept above the real floor (tracking.h), within 1e-3 to 1e3 of the first.
WalkOutput step(WalkState& state, const WalkPlace& place, const WalkSettings& settings, const WalkInput& input);

/// The tracking space's origin has moved (OpenXR: the reference space changed), e.g. because the person asked for it:
/// they stay where they are in the world and face as they do; what is new is where the room lies around them. Call it
/// before the first step whose head is in the new space. nullopt: nobody knows by what; then the next head that comes
/// is taken to be where the last one was, level.
void recentred(WalkState& state, const std::optional<Pose>& newInOld);

}  // namespace ibr::app
