// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_cover.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "base/prefetch.h"
#include "base/wide.h"

namespace ibr {
namespace {

// A view's projection to tiles.
struct Tiling {
  glm::mat3 turn;
  glm::vec3 shift;
  glm::vec2 focal, middle;
};

// Arguments by value: references of std::max would prevent vectorisation of the loop below.
[[gnu::always_inline]] inline float inRange(float value, float most) {
  const float positive = value > 0 ? value : 0;
  return positive < most ? positive : most;
}

// Sets the tile that shows each point; −1: none. `points`: four values each, as in CellBounds::surface.
[[gnu::always_inline]] inline void tilesOf(const Tiling* tiling, const float* __restrict points,
                                           std::int32_t* __restrict tile, std::size_t count) {
  const Tiling t = *tiling;
  constexpr float kColumns = kCoverColumns, kRows = kCoverRows;
  for (std::size_t p = 0; p < count; ++p) {
    const float px = points[4 * p], py = points[4 * p + 1], pz = points[4 * p + 2], w = points[4 * p + 3];
    const float x = t.turn[0].x * px + t.turn[1].x * py + t.turn[2].x * pz + w * t.shift.x;
    const float y = t.turn[0].y * px + t.turn[1].y * py + t.turn[2].y * pz + w * t.shift.y;
    const float z = t.turn[0].z * px + t.turn[1].z * py + t.turn[2].z * pz + w * t.shift.z;
    const float column = t.middle.x + t.focal.x * x / -z, row = t.middle.y - t.focal.y * y / -z;
    const int at = int(inRange(row, kRows - 1)) * int(kCoverColumns) + int(inRange(column, kColumns - 1));
    const bool shown = (z < 0) & (column >= 0) & (row >= 0) & (column < kColumns) & (row < kRows);
    tile[p] = shown ? at : -1;
  }
}

using Worths = std::array<float, kCoverTiles>;

float gain(const Worths& covered, const CellCover& cell, float worth) {
  static_assert(kCoverTiles <= 128);
  const CellCover low(~std::uint64_t(0));
  float sum = 0;
  std::size_t first = 0;
  for (std::uint64_t tiles : {std::uint64_t((cell & low).to_ullong()), std::uint64_t((cell >> 64).to_ullong())}) {
    for (; tiles != 0; tiles &= tiles - 1)
      sum += std::max(0.0f, worth - covered[first + std::size_t(std::countr_zero(tiles))]);
    first += 64;
  }
  return sum;
}

}  // namespace

CellCover coverOf(const CellBounds& cell, glm::dvec3 origin, std::span<const Camera> views) {
  constexpr std::size_t kChunk = 128;
  prefetch(cell.surface.data(), cell.surface.size() * sizeof cell.surface[0]);
  CellCover cover;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Camera& view = views[v];
    const Intrinsics& k = view.intrinsics;
    // Position in tiles = middle + focal · tangent.
    const glm::vec2 tiles(kCoverColumns, kCoverRows), size(k.width, k.height);
    const Tiling tiling{glm::mat3(glm::mat3_cast(glm::conjugate(view.pose.rotation))),
                        glm::vec3(glm::conjugate(view.pose.rotation) * (origin - view.pose.position)),
                        glm::vec2(k.fx, k.fy) * tiles / size, glm::vec2(k.cx, k.cy) * tiles / size};
    for (std::size_t first = 0; first < cell.surface.size(); first += kChunk) {
      std::array<std::int32_t, kChunk> tile;
      const std::size_t count = std::min(kChunk, cell.surface.size() - first);
      runVectorised<tilesOf>(&tiling, &cell.surface[first].x, tile.data(), count);
      for (std::size_t p = 0; p < count; ++p)
        if (tile[p] >= 0) cover.set(v * kCoverRows * kCoverColumns + std::size_t(tile[p]));
    }
  }
  return cover;
}

CellCover tilesOfViews(std::size_t views) {
  return ~CellCover() >> (kCoverTiles - views * kCoverRows * kCoverColumns);
}

// Gains never grow while cells are chosen, not even when rounded: each is a sum of the same terms in the same order. A
// previous gain, and the gain of a cell that would cover all tiles, are therefore upper bounds. Few gains are computed
// again, and few covers at all.
std::pmr::vector<std::size_t> coveringCells(const std::function<CellCover(std::size_t)>& coverOf,
                                            const CellCover& tiles, std::span<const double> worth, double behind,
                                            std::size_t most, std::size_t forced, std::pmr::memory_resource* memory) {
  const std::size_t count = worth.size();
  std::pmr::vector<std::size_t> chosen(memory);
  if (behind == 0 && count <= most) {
    for (std::size_t c = 0; c < count; ++c) chosen.push_back(c);
    return chosen;
  }
  struct Candidate {
    CellCover cover;  // all tiles until it is computed
    bool isComputed = false;
    float bound = std::numeric_limits<float>::infinity();  // of the gain; −1: chosen
  };
  Worths covered;
  covered.fill(float(behind));
  std::pmr::vector<Candidate> cells(count, Candidate{tiles}, memory);
  const auto compute = [&](std::size_t c) {
    cells[c].cover = coverOf(c);
    cells[c].isComputed = true;
  };
  const auto take = [&](std::size_t c) {  // a cover that is not computed adds nothing
    chosen.push_back(c);
    cells[c].bound = -1;
    for (std::size_t tile = 0; tile < kCoverTiles; ++tile)
      if (cells[c].cover[tile]) covered[tile] = std::max(covered[tile], float(worth[c]));
  };
  if (forced < count) {
    compute(forced);
    take(forced);
  }
  while (chosen.size() < std::min(most, count)) {
    std::size_t best = count;
    float largest = -1;
    const auto mayBeBest = [&](std::size_t c) {  // among equal gains the first cell wins
      const float bound = cells[c].bound;
      return bound > largest || (bound == largest && bound >= 0 && c < best);
    };
    // Starts with the largest bound, which is likely to be the largest gain.
    const auto highest = std::size_t(std::ranges::max_element(cells, {}, &Candidate::bound) - cells.begin());
    for (std::size_t i = 0; i <= count; ++i) {
      const std::size_t c = i == 0 ? highest : i - 1;
      if (!mayBeBest(c)) continue;
      Candidate& cell = cells[c];
      cell.bound = gain(covered, cell.cover, float(worth[c]));
      if (!cell.isComputed && cell.bound > 0 && mayBeBest(c)) {
        compute(c);
        cell.bound = gain(covered, cell.cover, float(worth[c]));
      }
      if (mayBeBest(c)) largest = cell.bound, best = c;
    }
    if (behind > 0 && !(largest > 0)) break;
    take(best);
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace ibr
