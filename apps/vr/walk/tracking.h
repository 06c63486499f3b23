// SPDX-License-Identifier: Apache-2.0
// Transform from tracking space (the user's room) to the world.
//
// Tracking space: metres, right-handed, y up, floor at y = 0, as in OpenXR's STAGE space (a chosen eye height makes
// LOCAL equivalent). World: the scene's, with any scale and any up direction, possibly far from its origin. All
// functions are pure; rotations are unit, numbers finite.
#pragma once

#include "ibr/camera.h"

namespace ibr::app {

/// Maps tracking space to the world: world = origin + rotation · (unitsPerMetre · point).
struct Tracking {
  glm::dvec3 origin{0.0};                   // world position of the tracking space's origin, on the floor
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit, tracking axes to world axes
  double unitsPerMetre = 1;                 // > 0
};

glm::dvec3 inWorld(const Tracking& tracking, glm::dvec3 point);
Pose inWorld(const Tracking& tracking, const Pose& pose);
glm::dvec3 inTracking(const Tracking& tracking, glm::dvec3 point);
Pose inTracking(const Tracking& tracking, const Pose& pose);

/// Returns the room's up direction in the world, unit.
glm::dvec3 upInWorld(const Tracking& tracking);

/// Returns the horizontal part of a viewing direction, unit. For a view straight up or down: the direction of the chin
/// or of the top of the head. `up`: unit, in the space that the rotation leads to.
glm::dvec3 facingOf(const glm::dquat& rotation, glm::dvec3 up = {0, 1, 0});

/// Returns the head's rotation about y from −z, radians, positive to the left, in (−π, π].
double headingOf(const glm::dquat& rotation);

/// Returns a tracking at the world's origin, level with `up` (any length above 0).
Tracking levelTracking(glm::dvec3 up, double unitsPerMetre = 1);

/// Moves the tracking so that the point of the floor below the head lies on `ground` (world); nothing else changes.
Tracking stoodOn(const Tracking& tracking, const Pose& head, glm::dvec3 ground);

/// Turns to the left by `radians` about the vertical through the head, whose position stays.
Tracking turned(const Tracking& tracking, const Pose& head, double radians);

/// Turns likewise until the head faces the horizontal part of `direction` (world).
Tracking turnedTo(const Tracking& tracking, const Pose& head, glm::dvec3 direction);

/// Changes the scale. The fixed point lies `fixedHeightMetres` above the real floor on the vertical through the head;
/// eyes and floor keep their horizontal positions. Poses of photographs have no metric scale, so the user may adjust
/// it. With the photographs' height above ground as `fixedHeightMetres`, that height stays and the eyes of a standing
/// user hardly move. The eye distance and the length of steps change. standAt at the new scale gives the same. 0: the
/// ground stays; the user becomes larger or smaller.
Tracking scaled(const Tracking& tracking, const Pose& head, double fixedHeightMetres, double unitsPerMetre);

/// Adapts to a moved tracking space; `newInOld`: pose of its new origin in the previous axes. The head keeps its place
/// and facing in the world; the floor stays level and at its height.
Tracking recentred(const Tracking& tracking, const Pose& newInOld);

}  // namespace ibr::app
