// SPDX-License-Identifier: Apache-2.0
// Where the room that a person stands in lies in the world.
//
// Tracking space is the room: metres, right-handed, y up, the floor at y = 0, as OpenXR's STAGE (LOCAL is made to look
// like it by a chosen eye height). The world is the scene's: any scale, any up, possibly far from its origin.
// Everything here is pure; rotations are unit, numbers finite.
#pragma once

#include "ibr/camera.h"

namespace ibr::app {

/// From tracking space to the world: world = origin + rotation · (unitsPerMetre · point).
struct Tracking {
  glm::dvec3 origin{0.0};                   // world: where the tracking space's origin, on the floor, lies
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit, tracking axes to the world's
  double unitsPerMetre = 1;                 // > 0
};

glm::dvec3 inWorld(const Tracking& tracking, glm::dvec3 point);
Pose inWorld(const Tracking& tracking, const Pose& pose);
glm::dvec3 inTracking(const Tracking& tracking, glm::dvec3 point);
Pose inTracking(const Tracking& tracking, const Pose& pose);

/// The world's up under a person's feet, unit.
glm::dvec3 upInWorld(const Tracking& tracking);

/// The horizontal part of a viewing direction, unit; straight up or down: where the head's top or chin points. `up` is
/// unit, of the space that the rotation leads to.
glm::dvec3 facingOf(const glm::dquat& rotation, glm::dvec3 up = {0, 1, 0});

/// Radians about tracking space's y that a head is turned from −z, to the left positive, in (−π, π].
double headingOf(const glm::dquat& rotation);

/// At the world's origin, level with `up` (any length above 0).
Tracking levelTracking(glm::dvec3 up, double unitsPerMetre = 1);

/// Moved so that what is below the head comes to stand on `ground` (world); nothing else changes.
Tracking stoodOn(const Tracking& tracking, const Pose& head, glm::dvec3 ground);

/// Turned about the vertical through the head, to the left by `radians`: the head keeps its place.
Tracking turned(const Tracking& tracking, const Pose& head, double radians);

/// Turned likewise so that the head comes to face `direction` (world), as far as that is horizontal.
Tracking turnedTo(const Tracking& tracking, const Pose& head, glm::dvec3 direction);

/// Another scale. What stays in the world is the point `keptMetres` above the real floor on the vertical through the
/// head: the eyes keep their place horizontally and the floor its place under the feet. A scale is changed because the
/// poses of photographs have no metres: with their height above ground as `keptMetres` they stay that high above the
/// real floor, eyes of a standing person hardly move, and what changes is how far two eyes, and steps, are apart.
/// standAt at the new scale gives the same. 0: the ground of the world stays, and a person becomes larger or smaller.
Tracking scaled(const Tracking& tracking, const Pose& head, double keptMetres, double unitsPerMetre);

/// The same after the tracking space has moved under the person: `newInOld` is the pose of its new origin in the old
/// one's axes. The head keeps its place and facing in the world; the floor is level and where it was.
Tracking recentred(const Tracking& tracking, const Pose& newInOld);

}  // namespace ibr::app
