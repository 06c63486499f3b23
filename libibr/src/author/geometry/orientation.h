// SPDX-License-Identifier: Apache-2.0
// On which side triangles of a mesh lie, without rounding: positions stand on a grid of 1/512 px, signed areas are
// whole numbers. What is positive here is positive for everybody who reads the stored floats.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace ibr {

inline constexpr double kGridPerPixel = 512.0;

/// The grid point nearest to a position; a float holds it for pictures of up to 32768 px.
inline glm::vec2 snapped(glm::dvec2 px) {
  return {float(std::round(px.x * kGridPerPixel) / kGridPerPixel),
          float(std::round(px.y * kGridPerPixel) / kGridPerPixel)};
}

/// Twice the signed area of a triangle, in squares of the grid: exact. Positive: as the picture's axes turn, x to y.
/// Precondition: corners on the grid, within ±32768 px.
inline std::int64_t twiceArea(std::span<const glm::vec2> at, const glm::uvec3& t) {
  const auto whole = [](float px) { return std::int64_t(double(px) * kGridPerPixel); };
  const std::int64_t x = whole(at[t.x].x), y = whole(at[t.x].y);
  return (whole(at[t.y].x) - x) * (whole(at[t.z].y) - y) - (whole(at[t.y].y) - y) * (whole(at[t.z].x) - x);
}

}  // namespace ibr
