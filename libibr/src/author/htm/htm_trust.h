// SPDX-License-Identifier: Apache-2.0
// What a match counts that is not where the others want it.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ibr {

/// The larger eigenvalue of a match's information (xx, xy, yy): what it knows in the direction that it knows best.
inline double strengthOf(const glm::dvec3& information) {
  return 0.5 * (information.x + information.z) + std::hypot(0.5 * (information.x - information.z), information.y);
}

/// The weight of Geman and McClure 1987, 1 to 0, of a residual (px) of a match with that information (xx, xy, yy) and
/// its strengthOf: a quarter where it is outlierPx off. Only what the match has measured counts, so that stripes, which
/// are displaced along their gradient alone, are not doubted for what they do not say.
inline double trustOf(const glm::dvec3& information, double strength, const glm::dvec2& residual, double outlierPx) {
  if (!(strength > 0)) return 1;
  const double squares = (information.x * residual.x * residual.x + 2 * information.y * residual.x * residual.y +
                          information.z * residual.y * residual.y) /
                         strength;
  const double trust = outlierPx * outlierPx / (outlierPx * outlierPx + std::fmax(squares, 0));
  return trust * trust;
}
inline double trustOf(const glm::dvec3& information, const glm::dvec2& residual, double outlierPx) {
  return trustOf(information, strengthOf(information), residual, outlierPx);
}

}  // namespace ibr
