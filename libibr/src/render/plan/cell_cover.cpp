// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_cover.h"

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace ibr {
namespace {

using Worths = std::array<float, kCoverTiles>;

float gain(const Worths& covered, const Worths& cell) {
  float sum = 0;
  for (std::size_t tile = 0; tile < kCoverTiles; ++tile) sum += std::max(0.0f, cell[tile] - covered[tile]);
  return sum;
}

}  // namespace

CellCover coverOf(const CellBounds& cell, glm::dvec3 origin, std::span<const Camera> views) {
  CellCover cover;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Camera& view = views[v];
    const Intrinsics& k = view.intrinsics;
    const glm::mat3 turn(glm::mat3_cast(glm::conjugate(view.pose.rotation)));
    const glm::vec3 shift(glm::conjugate(view.pose.rotation) * (origin - view.pose.position));
    // Position in tiles = middle + focal · tangent.
    const glm::vec2 tiles(kCoverColumns, kCoverRows), size(k.width, k.height);
    const glm::vec2 focal = glm::vec2(k.fx, k.fy) * tiles / size, middle = glm::vec2(k.cx, k.cy) * tiles / size;
    for (const glm::vec4& point : cell.surface) {
      const glm::vec3 direction = turn * glm::vec3(point) + point.w * shift;
      if (!(direction.z < 0)) continue;
      const glm::vec2 at = middle + focal * glm::vec2(direction.x, -direction.y) / -direction.z;
      if (at.x >= 0 && at.y >= 0 && at.x < tiles.x && at.y < tiles.y)
        cover.set((v * kCoverRows + std::size_t(at.y)) * kCoverColumns + std::size_t(at.x));
    }
  }
  return cover;
}

std::vector<std::size_t> coveringCells(std::span<const CellCover> covers, std::span<const double> worth, double behind,
                                       std::size_t most, std::size_t forced) {
  const std::size_t count = covers.size();
  const bool all = behind == 0 && count <= most;
  std::vector<bool> chosen(count, all);
  if (!all) {
    std::vector<Worths> cells(count);
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile) cells[c][tile] = covers[c][tile] ? float(worth[c]) : 0.0f;
    Worths covered;
    covered.fill(float(behind));
    const auto take = [&](std::size_t cell) {
      chosen[cell] = true;
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile) covered[tile] = std::max(covered[tile], cells[cell][tile]);
    };
    if (forced < count) take(forced);
    for (std::size_t taken = forced < count ? 1 : 0; taken < std::min(most, count); ++taken) {
      std::size_t best = count;
      float largest = -1;
      for (std::size_t c = 0; c < count; ++c) {
        if (chosen[c]) continue;
        if (const float here = gain(covered, cells[c]); here > largest) largest = here, best = c;
      }
      if (behind > 0 && !(largest > 0)) break;
      take(best);
    }
  }
  std::vector<std::size_t> result;
  for (std::size_t c = 0; c < count; ++c)
    if (chosen[c]) result.push_back(c);
  return result;
}

}  // namespace ibr
