// SPDX-License-Identifier: Apache-2.0
// One observation in a bundle adjustment, with its derivatives (bundle_adjust.h).
//
// A point h = u + a·e1 + b·e2 at inverse distance w from its anchor c0, seen by a camera rotated by δ and translated by
// t, has the camera coordinates q = exp(−δ) R₀ᵀ (h + w (c0 − c₀ − t)), up to a positive factor: finite at w = 0.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "ibr/camera.h"

namespace ibr {

inline constexpr int kPoseUnknowns = 6;   // δ about the camera's axes, radians; t in the world
inline constexpr int kLensUnknowns = 3;   // logarithm of the focal lengths' factor; the principal point's shift, px
inline constexpr int kPointUnknowns = 3;  // a, b, w

struct AnchoredPoint {
  glm::dvec3 anchor;             // world
  glm::dvec3 direction, e1, e2;  // unit, orthogonal
  double inverseDistance;        // at the start
};

/// `position` is homogeneous. Precondition: differs from the anchor, w >= 0.
AnchoredPoint anchorPoint(const glm::dvec4& position, const glm::dvec3& anchor);
/// Returns homogeneous coordinates.
glm::dvec4 placedPoint(const AnchoredPoint& point, const double* unknowns);
Camera movedCamera(const Camera& start, const double* pose, const double* lens);

struct BundleResidual {
  glm::dvec2 off;  // projected − seen, px
  std::array<std::array<double, kPoseUnknowns>, 2> poseJacobian;
  std::array<std::array<double, kLensUnknowns>, 2> lensJacobian;
  std::array<std::array<double, kPointUnknowns>, 2> pointJacobian;
};

/// nullopt if the point is behind the camera. Without `derivatives` these are left unset.
std::optional<BundleResidual> bundleResidual(const Camera& start, const AnchoredPoint& point, glm::dvec2 pixel,
                                             const double* pose, const double* lens, const double* pointUnknowns,
                                             bool derivatives);

}  // namespace ibr
