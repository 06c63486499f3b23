// SPDX-License-Identifier: Apache-2.0
// Fits the small rigid motion that aligns directions seen in one mesh with the same points seen in another mesh.
// Iteratively reweighted least squares on angles, with Cauchy weights. Pure.
#pragma once

#include <array>
#include <glm/gtc/type_precision.hpp>
#include <memory_resource>
#include <span>

namespace ibr {

/// Rotation vector (radians), then translation; about the eye. A point in direction u at distance s has nearness
/// n = 1/s. After the motion the point is seen along exp(rotation)·u + n·translation.
using Motion = std::array<double, 6>;

/// Direction and nearness of a point, seen from the eye.
struct Observation {
  glm::dvec3 direction;  // unit
  double nearness;       // >= 0, in the inverse of the translation's unit
};

/// One point, as two meshes show it.
struct ObservationPair {
  Observation from, to;
  double weight;  // > 0
};

/// For another motion x the weighted sum of squares grows by (x − motion)ᵀ · information · (x − motion).
struct MotionFit {
  Motion motion{};
  std::array<Motion, 6> information{};
  double explained = 0;  // 0 … 1: share of the pairs' squared distances that the motion removes
};
/// `memory` is used for the call.
MotionFit fitMotion(std::span<const ObservationPair> pairs,
                    std::pmr::memory_resource* memory = std::pmr::get_default_resource());

glm::dquat rotationOf(const Motion& motion);

/// Returns x with A·x = b for a positive definite A (Cholesky). Unknowns that A does not determine are 0.
Motion solved(std::array<Motion, 6> a, Motion b);

}  // namespace ibr
