// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec2.hpp>

namespace ibr::test {

/// Returns true for a point inside a triangle of any orientation, or on its border.
inline bool isInside(const std::array<glm::dvec2, 3>& triangle, glm::dvec2 point) {
  const auto side = [&](glm::dvec2 a, glm::dvec2 b) {
    return (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x);
  };
  const auto& [p, q, r] = triangle;
  const double a = side(p, q), b = side(q, r), c = side(r, p);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

}  // namespace ibr::test
