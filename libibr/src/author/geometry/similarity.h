// SPDX-License-Identifier: Apache-2.0
// What turns, scales and shifts the world of one set of poses into that of another.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/camera.h"

namespace ibr {

/// x → scale · rotation · x + shift.
struct Similarity {
  double scale = 1;
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 shift{0.0};

  glm::dvec3 operator()(const glm::dvec3& point) const { return scale * (rotation * point) + shift; }
  Pose operator()(const Pose& pose) const { return {(*this)(pose.position), glm::normalize(rotation * pose.rotation)}; }
};

/// The similarity that brings poses closest to as many others: by least squares of positions (Umeyama 1991) and of
/// rotations together, each weighed by how far they stay off, so that whichever is better known tells more. Rotations
/// alone tell the turn where positions lie on a line; the scale stays 1 where all are in one place. None: identity.
Similarity aligned(std::span<const Pose> from, std::span<const Pose> to);

/// The angle of the turn between them, radians.
double angleBetween(const glm::dquat& a, const glm::dquat& b);

}  // namespace ibr
