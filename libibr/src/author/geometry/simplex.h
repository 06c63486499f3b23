// SPDX-License-Identifier: Apache-2.0
// Lines, triangles and tetrahedra of camera centres.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace ibr {

/// Indices of 2 to 4 corners, ascending.
using Simplex = std::vector<std::uint32_t>;

/// All simplices with one corner less.
std::vector<Simplex> faces(const Simplex& simplex);

/// 1 for a regular simplex, 0 for a degenerate one: its area or volume over that of the regular one with the same mean
/// squared edge. 1 for a line of any positive length.
double shape(std::span<const glm::dvec3> corners);

double longestEdge(std::span<const glm::dvec3> corners);

/// Foot of a point in the simplex's own span, and the distance from the span. Precondition: shape(corners) > 0.
struct Location {
  std::array<double, 4> weights{};  // barycentric coordinates of the foot, 0 beyond the corners
  double distance = 0;              // from point to foot
};
Location locate(std::span<const glm::dvec3> corners, glm::dvec3 point);

}  // namespace ibr
