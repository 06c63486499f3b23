// SPDX-License-Identifier: Apache-2.0
// Sums of squared distances from planes (Garland, Heckbert, Surface simplification using quadric error metrics, 1997).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace ibr {

/// Σ w (n·x − d)² = xᵀAx − 2b·x + c.
struct Quadric {
  glm::dmat3 a = glm::dmat3(0.0);
  glm::dvec3 b = glm::dvec3(0.0);
  double c = 0;

  /// Adds a plane through a point; `normal` has length 1.
  void addPlane(glm::dvec3 normal, glm::dvec3 through, double weight) {
    const double d = glm::dot(normal, through);
    a += weight * glm::outerProduct(normal, normal);
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  /// Value at x, >= 0 up to rounding.
  double at(glm::dvec3 x) const { return glm::dot(x, a * x) - 2.0 * glm::dot(b, x) + c; }

  /// Minimum, pulled towards `near` in directions that the planes leave (almost) free; `near` itself if there are no
  /// planes.
  glm::dvec3 minimum(glm::dvec3 near) const {
    const double trace = a[0][0] + a[1][1] + a[2][2];
    if (!(trace > 0)) return near;
    constexpr double kPull = 1e-6;
    const glm::dmat3 drawn = a + kPull * trace * glm::dmat3(1.0);
    const glm::dvec3 result = near + glm::inverse(drawn) * (b - a * near);
    return std::isfinite(result.x + result.y + result.z) ? result : near;
  }
};

}  // namespace ibr
