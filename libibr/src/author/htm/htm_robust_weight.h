// SPDX-License-Identifier: Apache-2.0
// Robust weights of matches that depart from the values wanted.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ibr {

/// Returns the larger eigenvalue of a match's information (xx, xy, yy): the precision in its best direction.
inline double maxInformation(const glm::dvec3& information) {
  return 0.5 * (information.x + information.z) + std::hypot(0.5 * (information.x - information.z), information.y);
}

/// Returns the weight (1 to 0) of Geman and McClure 1987 for a residual (px) of a match with that information and its
/// maxInformation: a quarter at outlierPx. Only measured directions count: stripes, displaced along their gradient
/// only, are not penalised along the stripe.
inline double robustWeight(const glm::dvec3& information, double strength, const glm::dvec2& residual,
                           double outlierPx) {
  if (!(strength > 0)) return 1;
  const double squares = (information.x * residual.x * residual.x + 2 * information.y * residual.x * residual.y +
                          information.z * residual.y * residual.y) /
                         strength;
  const double trust = outlierPx * outlierPx / (outlierPx * outlierPx + std::fmax(squares, 0));
  return trust * trust;
}
inline double robustWeight(const glm::dvec3& information, const glm::dvec2& residual, double outlierPx) {
  return robustWeight(information, maxInformation(information), residual, outlierPx);
}

}  // namespace ibr
