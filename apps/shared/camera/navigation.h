// SPDX-License-Identifier: Apache-2.0
// How a person's hands move a camera: flying, looking, orbiting, flying to a view. No window, no clock; double
// precision, so that a world whose origin is far away moves as smoothly as any. The same hands give the same path at
// every rate of frames: motion with inertia is solved exactly over each step, about the middle of what is turned in it.
#pragma once

#include <optional>

#include "ibr/camera.h"
#include "shared/camera/roaming.h"

namespace ibr::app {

/// What hands did since the last step. Anything not finite, and seconds below 0, is refused.
struct NavigationInput {
  double seconds = 0;   // since the last step; more than a second counts as one
  glm::dvec3 move{0};   // right and back along the view's axes, up (y) along the world's; each −1 to 1
  glm::dvec2 look{0};   // px that the pointer went, x right, y down: the view turns that way
  glm::dvec2 orbit{0};  // px likewise: the camera goes round the centre as if the pointer pulled the world
  double wheel = 0;     // notches; each changes the speed by a fifth
  bool fast = false, slow = false;
};

/// A way to a view, eased at both ends.
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
  std::optional<glm::dvec3> centre;  // what orbits go round; none: orbit does nothing
  glm::dvec3 velocity{0};            // world units a second
  std::optional<Flight> flight;
};

/// Moves the camera and says whether it goes on by itself, so that another frame is due without input. Looking keeps
/// within 89° of the horizon (a view that is beyond may stay, or come back) and neither makes nor takes away roll.
/// Orbits keep the centre's distance and its place in the picture. Any move, look or orbit ends a flight; a flight's
/// last step gives its view to the last bit. Within `bounds`, hands cannot lead out (roaming.h); flights do not ask.
/// Throws Error{invalidInput} for input that is not finite, and `state` is as before.
bool navigate(Navigation& state, const NavigationInput& input, const RoamingBounds* bounds = nullptr);

/// Begins a flight; 0 seconds: is there at once.
void flyTo(Navigation& state, const Pose& pose, double fovY, double seconds);

/// The point of the world that a pixel (px) shows at `depth` along the viewing axis (world units); nullopt where there
/// is none: depth that is not finite or not above 0.
std::optional<glm::dvec3> pickedPoint(const Camera& camera, glm::dvec2 pixel, double depth);

/// Looks the same way with the horizon level; straight up or down: as it is.
Pose levelled(const Pose& pose, glm::dvec3 up);

}  // namespace ibr::app
