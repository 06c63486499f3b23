// SPDX-License-Identifier: Apache-2.0
// Locomotion: teleports to photographed spots, turns in steps and, if enabled, smooth motion.
//
// A pure state machine without clock and OpenXR. Without input, the tracking stays unchanged to the last bit. Without a
// head, nothing moves. Inputs that are not finite are ignored.
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

/// A scene to walk through; created by makeWalkScene.
struct WalkScene {
  Spots spots;
  glm::dvec3 up{0, 1, 0};    // unit, world
  RoamingBounds level;       // limits of the eyes, projected along `up` through the world's origin; no positions: none
  double unitsPerMetre = 1;  // initial, > 0
};

/// `bounds`: as for any camera (roaming.h). Smooth motion is level, so only the horizontal part counts.
WalkScene makeWalkScene(std::vector<Spot> spots, glm::dvec3 up, double unitsPerMetre, RoamingBounds bounds);

/// All values must be finite.
struct WalkSettings {
  double snapTurn = std::numbers::pi / 6;  // radians per turn; 0: the stick does not turn
  bool smoothMotion = false;
  double metresPerSecond = 1.4;         // with the stick fully pushed
  double vignette = 0.8;                // strength at full speed, 0 to 1
  double photographHeightMetres = 1.6;  // of the cameras above the ground
};

/// State of one hand in this step.
struct HandInput {
  bool active = false;
  Pose aim;               // tracking space, pointing along −z
  bool select = false;    // held
  bool menu = false;      // held
  glm::dvec2 stick{0.0};  // −1 to 1, x right, y forward
  double turn = 0;        // −1 to 1, to the right, for controllers that turn by other means than a stick
  bool onPanel = false;   // the ray hits the menu panel, which then gets the selection
};

enum Hand : std::size_t { kLeft = 0, kRight = 1 };

struct WalkInput {
  double seconds = 0;        // since the last step; limited to 0.1
  std::optional<Pose> head;  // tracking space, between the eyes; nullopt: not tracked
  std::array<HandInput, 2> hands;
  std::optional<std::size_t> teleportTo;  // spot chosen otherwise (on the map), as if pointed at
  double scale = 1;                       // factor on world units per metre; > 0
  bool black = false;                     // fades out and stays black while true, for a change of the scene
};

enum class FadePhase : std::uint8_t { clear, out, in };

/// State from step to step. Created by startWalk.
struct WalkState {
  static constexpr int kUnseen = 2;  // value of turnedTo: the stick has not been seen in the middle
  struct HandState {
    enum class Select : std::uint8_t { unknown, free, aiming, panel };
    Select select = Select::unknown;  // unknown: already held when first seen
    bool menuReleased = false;        // has been seen released
    std::optional<std::size_t> pointed;
  };
  Tracking tracking;
  double initialUnitsPerMetre = 1;
  std::array<HandState, 2> hands;
  std::size_t turningHand = kRight;
  int turnedTo = kUnseen;  // side that the stick has turned to; 0: seen in the middle
  FadePhase phase = FadePhase::in;
  double fade = 1;                    // 0 to 1
  double vignette = 0;                // 0 to 1
  std::optional<std::size_t> wanted;  // spot to jump to when the view is black
  bool faceSpotOnJump = true;         // until the first jump, which faces as the spot's photographs do
  std::optional<Pose> lastHead;       // tracking space
  bool realign = false;               // the tracking space has moved by an unknown amount
};

struct HandOutput {
  bool aiming = false;                 // shows the hand's ray and the marks of spots
  std::optional<std::size_t> pointed;  // spot
  bool panelSelect = false;            // select is held and belongs to the panel
};

struct WalkOutput {
  Tracking tracking;    // for this frame
  double fade = 0;      // black drawn over this frame, 0 to 1
  double vignette = 0;  // strength
  bool jumped = false;  // the head has moved to another spot since the previous frame; only while fade is 1
  bool turned = false;  // by a snap turn
  bool menuToggled = false;
  bool showMarks = false;  // a hand is aiming
  std::array<HandOutput, 2> hands;
  std::optional<std::size_t> arrived;  // spot of the jump, in the frame that jumped
};

inline constexpr double kFadeOutSeconds = 0.12, kFadeInSeconds = 0.2;

/// Starts black, about to jump to `spot` (nullopt or out of range: the world's origin), and fades in once a head is
/// tracked. The first jump faces as the spot's photographs do, later ones keep the facing.
WalkState startWalk(const WalkScene& place, const WalkSettings& settings, std::optional<std::size_t> spot);

/// Advances by one frame.
///
/// select: a held button aims; its release teleports to the spot pointed at. A press on the panel belongs to the panel
///   until released. A release on the panel, or without a tracked hand and head, does nothing. A press from before
///   this state was created is ignored.
/// stick: x of the right hand, or of a single tracked hand, turns once when beyond 0.7; it must return to within 0.35
///   before the next turn, and before the first. With smoothMotion the left stick moves the user level, relative to
///   the facing of the head, within the scene's bounds.
/// teleportTo, or another teleport, during a fade: the last request wins; the view stays black until the jump.
/// scale: at once; keeps the photographs' height above the real floor (tracking.h); within 1e-3 to 1e3 of the first.
WalkOutput step(WalkState& state, const WalkScene& place, const WalkSettings& settings, const WalkInput& input);

/// The tracking space's origin has moved (OpenXR: the reference space changed), for example at the user's request.
/// The user keeps position and facing in the world; the room around the user moves. Call before the first step whose
/// head is in the new space. nullopt: the change is unknown; the next head is then put where the last head was,
/// level.
void recentred(WalkState& state, const std::optional<Pose>& newInOld);

}  // namespace ibr::app
