// SPDX-License-Identifier: Apache-2.0
// Enumerates the pixel centres in a triangle.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ibr {

/// Calls visit(x, y, λ) for each pixel of a width × height image whose centre lies in the triangle or on its border. λ
/// are the barycentric coordinates of the pixel's centre. A degenerate triangle has no pixels; the orientation does not
/// matter.
template <class Visit>
void forTrianglePixels(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, int width, int height, Visit&& visit) {
  const glm::dvec2 ab = b - a, ac = c - a;
  const double area = ab.x * ac.y - ab.y * ac.x;
  if (!(std::abs(area) > 1e-12)) return;
  const auto first = [](double low) { return int(std::ceil(std::clamp(low - 0.5, -1.0, 1e6))); };
  const auto last = [](double high) { return int(std::floor(std::clamp(high - 0.5, -1.0, 1e6))); };
  const int left = std::max(0, first(std::min({a.x, b.x, c.x}))),
            right = std::min(width - 1, last(std::max({a.x, b.x, c.x})));
  const int top = std::max(0, first(std::min({a.y, b.y, c.y}))),
            bottom = std::min(height - 1, last(std::max({a.y, b.y, c.y})));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const glm::dvec2 p = glm::dvec2(x + 0.5, y + 0.5) - a;
      const double atB = (p.x * ac.y - p.y * ac.x) / area, atC = (ab.x * p.y - ab.y * p.x) / area;
      constexpr double kEdgeTolerance = -1e-9;
      if (atB >= kEdgeTolerance && atC >= kEdgeTolerance && 1 - atB - atC >= kEdgeTolerance)
        visit(x, y, glm::dvec3(1 - atB - atC, atB, atC));
    }
}

}  // namespace ibr
