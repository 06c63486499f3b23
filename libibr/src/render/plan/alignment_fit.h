// SPDX-License-Identifier: Apache-2.0
// The small rigid motion that brings what one mesh says to what another one says of the same places: iteratively
// reweighted least squares on angles, with Cauchy's weights. Pure.
#pragma once

#include <array>
#include <glm/gtc/type_precision.hpp>
#include <span>

namespace ibr {

/// Rotation vector (radians), then translation; about the eye. A place in direction u at distance s, nearness n = 1/s,
/// is afterwards seen along exp(rotation)·u + n·translation.
using Motion = std::array<double, 6>;

/// Where a place is seen.
struct Sight {
  glm::dvec3 direction;  // unit
  double nearness;       // >= 0, in the inverse of the translation's unit
};

/// One place, as two meshes show it.
struct SightPair {
  Sight from, to;
  double weight;  // > 0
};

/// Of a motion: (x − motion)ᵀ · information · (x − motion) is by how much the weighted squares grow for another one.
struct MotionFit {
  Motion motion{};
  std::array<Motion, 6> information{};
  double explained = 0;  // 0 … 1: share of the pairs' squared distances that the motion takes away
};
MotionFit fitMotion(std::span<const SightPair> pairs);

glm::dquat rotationOf(const Motion& motion);

/// x with A·x = b for a positive definite A (Cholesky); what is not determined is 0.
Motion solved(std::array<Motion, 6> a, Motion b);

}  // namespace ibr
