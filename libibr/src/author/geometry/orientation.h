// SPDX-License-Identifier: Apache-2.0
// Exact orientation of mesh triangles: positions lie on a grid of 1/512 px, so signed areas are integers. Every reader
// of the stored floats gets the same sign.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace ibr {

inline constexpr double kGridPerPixel = 512.0;

/// Grid point nearest to a position; exact in float for images of up to 32768 px.
inline glm::vec2 snapped(glm::dvec2 px) {
  return {float(std::round(px.x * kGridPerPixel) / kGridPerPixel),
          float(std::round(px.y * kGridPerPixel) / kGridPerPixel)};
}

/// Twice the signed area of a triangle, in grid squares: exact. Positive: corners turn from the x axis towards the y
/// axis. Precondition: corners on the grid, within ±32768 px.
inline std::int64_t twiceArea(std::span<const glm::vec2> at, const glm::uvec3& t) {
  const auto whole = [](float px) { return std::int64_t(double(px) * kGridPerPixel); };
  const std::int64_t x = whole(at[t.x].x), y = whole(at[t.x].y);
  return (whole(at[t.y].x) - x) * (whole(at[t.z].y) - y) - (whole(at[t.y].y) - y) * (whole(at[t.z].x) - x);
}

}  // namespace ibr
