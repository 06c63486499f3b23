// SPDX-License-Identifier: Apache-2.0
// What a match counts that is not where the others want it.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ibr {

/// The weight of Geman and McClure 1987, 1 to 0, of a residual (px) of a match with that information (xx, xy, yy): a
/// quarter where it is outlierPx off. Only what the match has measured counts, so that stripes, which are displaced
/// along their gradient alone, are not doubted for what they do not say.
inline double trustOf(const glm::dvec3& information, const glm::dvec2& residual, double outlierPx) {
  const double larger =
      0.5 * (information.x + information.z) + std::hypot(0.5 * (information.x - information.z), information.y);
  if (!(larger > 0)) return 1;
  const double squares = (information.x * residual.x * residual.x + 2 * information.y * residual.x * residual.y +
                          information.z * residual.y * residual.y) /
                         larger;
  const double trust = outlierPx * outlierPx / (outlierPx * outlierPx + std::fmax(squares, 0));
  return trust * trust;
}

}  // namespace ibr
