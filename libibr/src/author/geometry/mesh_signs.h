// SPDX-License-Identifier: Apache-2.0
// Signs of a triangle of a morphing mesh: in each image, in the mean of each pair of images, and in the mean of all.
//
// Signs are exact in double precision for positions on a grid of up to 1/512 px (orientation.h, ibr/optimiser.h) in
// images of up to 16384 px, also for sums of four. Elsewhere an area within rounding errors counts as not positive.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace ibr {

/// True if a triangle is certainly positive: its corners turn from the x axis towards the y axis.
inline bool turnsRight(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  return left - right > 0x1p-50 * (std::abs(left) + std::abs(right));
}

/// One bit each: images, means of pairs, mean of all; set where the triangle is positive. `match`: d × n, d <= 4, px.
inline std::uint32_t meshSigns(const std::vector<std::vector<glm::vec2>>& match, const glm::uvec3& t) {
  std::uint32_t signs = 0, bit = 1;
  const auto note = [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    if (turnsRight(a, b, c)) signs |= bit;
    bit <<= 1;
  };
  glm::dvec2 sum[3] = {};
  for (std::size_t i = 0; i < match.size(); ++i) {
    const glm::dvec2 at[3] = {match[i][t.x], match[i][t.y], match[i][t.z]};
    note(at[0], at[1], at[2]);
    for (std::size_t j = 0; j < i; ++j)
      note(at[0] + glm::dvec2(match[j][t.x]), at[1] + glm::dvec2(match[j][t.y]), at[2] + glm::dvec2(match[j][t.z]));
    for (int k = 0; k < 3; ++k) sum[k] += at[k];
  }
  note(sum[0], sum[1], sum[2]);
  return signs;
}

/// The same triangle with opposite orientation.
inline glm::uvec3 turned(const glm::uvec3& t) {
  return {t.x, t.z, t.y};
}

/// All bits, for d images.
constexpr std::uint32_t allPositive(std::size_t d) {
  return (1u << (d + d * (d - 1) / 2 + 1)) - 1;
}

}  // namespace ibr
