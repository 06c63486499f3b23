// SPDX-License-Identifier: Apache-2.0
// Camera navigation by user input: flying, looking, orbiting, and flights to a view. Uses no window and no clock.
// Double precision keeps motion smooth far from the world's origin. The same input gives the same path at every frame
// rate: motion with inertia is solved exactly over each step, at the rotation in the middle of the step's turn.
#pragma once

#include <optional>

#include "ibr/camera.h"
#include "shared/camera/roaming.h"

namespace ibr::app {

/// User input since the previous step. Values that are not finite and negative seconds are refused.
struct NavigationInput {
  double seconds = 0;   // since the previous step; clamped to 1 s
  glm::dvec3 move{0};   // right and back along the view's axes, up (y) along the world's; each −1 to 1
  glm::dvec2 look{0};   // pointer motion, px, x right, y down: the view turns towards the pointer
  glm::dvec2 orbit{0};  // pointer motion, px: the camera orbits the centre as if the pointer dragged the world
  double wheel = 0;     // notches; each changes the speed by a fifth
  bool fast = false, slow = false;
};

/// Animated motion to a view, eased at both ends.
struct Flight {
  Pose from, to;
  double fromFovY = 0, toFovY = 0;
  double seconds = 0, elapsed = 0;
};

struct Navigation {
  Pose pose;
  double fovY = 1;                   // radians
  double speed = 1;                  // world units a second, > 0
  glm::dvec3 up{0, 1, 0};            // unit
  std::optional<glm::dvec3> centre;  // centre of orbits; nullopt: orbit has no effect
  glm::dvec3 velocity{0};            // world units a second
  std::optional<Flight> flight;
};

/// Moves the camera. Returns true if the motion continues, so another frame is due without input. Looking stays within
/// 89° of the horizon (a view beyond may stay or return) and does not change roll. Orbits keep the distance to the
/// centre and the centre's position in the image. Move, look or orbit input ends a flight. A flight ends exactly at its
/// view. Input cannot lead out of `bounds` (roaming.h); flights ignore the bounds. Throws Error{invalidInput} for input
/// that is not finite; `state` is then unchanged.
bool navigate(Navigation& state, const NavigationInput& input, const RoamingBounds* bounds = nullptr);

/// Starts a flight; with 0 seconds the camera is at the view at once.
void flyTo(Navigation& state, const Pose& pose, double fovY, double seconds);

/// Returns the world point at a pixel (px) and `depth` along the viewing axis (world units). nullopt: the depth is not
/// finite or not above 0, or the pixel's ray does not point forward.
std::optional<glm::dvec3> pickedPoint(const Camera& camera, glm::dvec2 pixel, double depth);

/// Returns the pose with the same viewing axis and a level horizon; unchanged if the axis is vertical.
Pose levelled(const Pose& pose, glm::dvec3 up);

}  // namespace ibr::app
