// SPDX-License-Identifier: Apache-2.0
// Pixels that a triangle covers in the mean of two images, row by row (shared/ecc.h, "Coverage").
#pragma once

#include <algorithm>
#include <array>

#include "optimise/row_sums.h"
#include "optimise/texels.h"
#include "shared/ecc.h"

namespace ibr {

/// Selects every step-th row of the mean: those with row mod step = phase.
struct RowChoice {
  int step = 1, phase = 0;
};

/// A point in two images.
struct Corner {
  glm::ivec2 source, target;                           // 1/128 px
  glm::ivec2 mean() const { return source + target; }  // 2⁻⁸ px
};

/// Maps from pixels of the mean to both images, inside one triangle.
struct TriangleMaps {
  shader::EccMap source, target;
  glm::ivec2 origin;  // mean of the first corner

  /// Returns false if the triangle cannot be judged.
  bool set(const Corner& a, const Corner& b, const Corner& c) {
    const glm::ivec2 ma = a.mean(), mb = b.mean(), mc = c.mean();
    const std::int64_t area = shader::eccArea(ma, mb, mc);
    if (area <= 0 || !shader::eccSizeFits(ma, mb, mc)) return false;
    source = shader::eccMap(ma, mb, mc, a.source, b.source, c.source, area);
    target = shader::eccMap(ma, mb, mc, a.target, b.target, c.target, area);
    origin = ma;
    return shader::eccGradientFits(source) && shader::eccGradientFits(target);
  }
};

/// Reads of an image from pixel (column, row) of the mean on.
inline RunSource runAt(const shader::EccMap& map, const Texels& texels, glm::ivec2 origin, int column, int row) {
  constexpr std::int64_t kTexel = std::int64_t(1) << shader::kEccCoordinateBits;
  constexpr int kDropped = shader::kEccCoordinateBits - shader::kEccRunBits;
  const std::int64_t x = shader::eccCoordinateAt(map.originX, map.xByX, map.xByY, origin, column, row);
  const std::int64_t y = shader::eccCoordinateAt(map.originY, map.yByX, map.yByY, origin, column, row);
  return {texels.at(int(x >> shader::kEccCoordinateBits), int(y >> shader::kEccCoordinateBits)),
          texels.stride,
          std::int32_t((x & (kTexel - 1)) >> kDropped),
          std::int32_t((y & (kTexel - 1)) >> kDropped),
          std::int32_t(map.xByX >> kDropped),
          std::int32_t(map.yByX >> kDropped)};
}

/// Calls run(column, row, pixels) for the pixels of a triangle of the mean, at most kEccRun of them each.
template <class Run>
void forEachRun(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c, RowChoice rows, const Run& run) {
  std::array<glm::ivec2, 3> byRow{a, b, c};
  std::ranges::sort(byRow, {}, &glm::ivec2::y);
  // Rows of the edge top–bottom, which the longest edge spans, too.
  const auto half = [&](glm::ivec2 top, glm::ivec2 bottom) {
    const int behind = shader::eccFirstRow(bottom.y);
    int row = shader::eccFirstRow(top.y);
    row += ((rows.phase - row) % rows.step + rows.step) % rows.step;
    if (row >= behind) return;
    shader::EccEdge near = shader::eccEdge(top, bottom, row, rows.step);
    shader::EccEdge far = shader::eccEdge(byRow[0], byRow[2], row, rows.step);
    for (; row < behind; row += rows.step) {
      const int last = int(std::max(near.column, far.column));
      for (int from = int(std::min(near.column, far.column)); from < last; from += shader::kEccRun)
        run(from, row, std::min(last - from, shader::kEccRun));
      shader::eccNextRow(near);
      shader::eccNextRow(far);
    }
  };
  half(byRow[0], byRow[1]);
  half(byRow[1], byRow[2]);
}

}  // namespace ibr
