// SPDX-License-Identifier: Apache-2.0
// Similarity transform between the worlds of two sets of poses.
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

/// Similarity that maps poses to as many others: least squares of positions (Umeyama 1991) and rotations together, each
/// weighted by its residual, so that the more accurate one counts more. Collinear positions take the rotation from the
/// rotations; coincident positions keep scale 1. No poses: identity.
Similarity aligned(std::span<const Pose> from, std::span<const Pose> to);

/// Angle between two rotations, radians.
double angleBetween(const glm::dquat& a, const glm::dquat& b);

}  // namespace ibr
