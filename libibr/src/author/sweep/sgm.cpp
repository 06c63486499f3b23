// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/sgm.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibr {
namespace {

// The most influential parameters: with a tenth of them, foliage and cobbles break into speckles, and each speckle that
// is too near hides other surfaces.
constexpr int kP1 = 40, kP2 = 400;   // of costs up to kMaxSweepCost
constexpr float kGuideEdge = 25.0f;  // grey levels that halve P2
constexpr float kDirections = 8;
constexpr std::int16_t kOutsideCost = 16000;  // cost of the levels before the first and after the last

std::int16_t smoothness(float guide, float neighbour) {
  return std::int16_t(std::max(float(kP2) / (1.0f + std::abs(guide - neighbour) / kGuideEdge), 3.0f * kP1));
}

// One step of a path. `before` and `here` have an entry before the first and after the last level; returns min(here).
std::int16_t step(const std::uint8_t* __restrict cost, const std::int16_t* __restrict before, std::int16_t least,
                  std::int16_t p2, std::int16_t* __restrict here, std::int16_t* __restrict sum, int levels) {
  const std::int16_t jump = std::int16_t(least + p2);
  std::int16_t smallest = kOutsideCost;
  for (int l = 0; l < levels; ++l) {
    const std::int16_t beside = std::int16_t(std::min(before[l - 1], before[l + 1]) + kP1);
    const std::int16_t value = std::int16_t(std::min(std::min(before[l], beside), jump) - least + cost[l]);
    here[l] = value;
    sum[l] = std::int16_t(sum[l] + value);
    smallest = std::min(smallest, value);
  }
  return smallest;
}

// Adds the choice to follow a plane, at level `from` in the previous pixel and `to` here; returns the new min(here),
// previously `smallest`.
std::int16_t follow(const std::uint8_t* cost, const std::int16_t* before, std::int16_t least, int from, int to,
                    std::int16_t smallest, std::int16_t* here, std::int16_t* sum, int levels) {
  const int change = to - from;
  const int first = std::max({to - kPlaneReach, change, 0});
  const int last = std::min({to + kPlaneReach, levels - 1 + change, levels - 1});
  for (int l = first; l <= last; ++l) {
    const std::int16_t value = std::int16_t(before[l - change] - least + cost[l]);
    if (value >= here[l]) continue;
    sum[l] = std::int16_t(sum[l] + value - here[l]);
    here[l] = value;
    smallest = std::min(smallest, value);
  }
  return smallest;
}

// Path costs of a row for one direction across rows, or of the previous pixel for the direction along the row.
struct PathRow {
  PathRow(int pixels, int levels) : stride(levels + 2), least(std::size_t(pixels), 0) {
    values.assign(std::size_t(pixels) * std::size_t(stride), 0);
    for (int p = 0; p < pixels; ++p) at(p)[-1] = at(p)[levels] = kOutsideCost;
  }
  std::int16_t* at(int pixel) { return &values[std::size_t(pixel) * std::size_t(stride) + 1]; }
  int stride;
  std::vector<std::int16_t> values, least;
};

// Processes four of the eight directions: from left, upper left, upper and upper right; mirrored for the other four.
void sweepOnce(const CostVolume& volume, bool mirrored, std::vector<std::int16_t>& sum) {
  const int width = volume.width, height = volume.height, levels = volume.levels;
  const int towards = mirrored ? -1 : 1;
  std::array<PathRow, 3> above{PathRow(width, levels), PathRow(width, levels), PathRow(width, levels)};
  std::array<PathRow, 3> here = above;
  PathRow side(2, levels);
  const float* const guide = volume.guide.values.data();
  std::vector<std::int16_t> zero(std::size_t(levels + 2), 0);
  zero.front() = zero.back() = kOutsideCost;
  for (int row = 0; row < height; ++row) {
    const int y = mirrored ? height - 1 - row : row;
    for (int column = 0; column < width; ++column) {
      const int x = mirrored ? width - 1 - column : column;
      const std::size_t pixel = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const std::uint8_t* const cost = &volume.cost[pixel * std::size_t(levels)];
      std::int16_t* const total = &sum[pixel * std::size_t(levels)];
      const int now = column & 1, before = now ^ 1;
      const auto from = [&](std::size_t other, const std::int16_t* last, std::int16_t least, std::int16_t* next) {
        std::int16_t smallest = step(cost, last, least, smoothness(guide[pixel], guide[other]), next, total, levels);
        for (const auto& plane : volume.planes)
          if (plane[other] != kNoLevel && plane[pixel] != kNoLevel)
            smallest = follow(cost, last, least, plane[other], plane[pixel], smallest, next, total, levels);
        return smallest;
      };
      if (column == 0)
        side.least[std::size_t(now)] = step(cost, &zero[1], 0, 0, side.at(now), total, levels);
      else
        side.least[std::size_t(now)] = from(std::size_t(std::ptrdiff_t(pixel) - towards), side.at(before),
                                            side.least[std::size_t(before)], side.at(now));
      for (int k = 0; k < 3; ++k) {
        const int beside = x + (k - 1);
        PathRow &last = above[std::size_t(k)], &next = here[std::size_t(k)];
        if (row == 0 || beside < 0 || beside >= width) {
          next.least[std::size_t(x)] = step(cost, &zero[1], 0, 0, next.at(x), total, levels);
        } else {
          const std::ptrdiff_t other = std::ptrdiff_t(y - towards) * width + beside;
          next.least[std::size_t(x)] =
              from(std::size_t(other), last.at(beside), last.least[std::size_t(beside)], next.at(x));
        }
      }
    }
    std::swap(above, here);
  }
}

}  // namespace

SemiGlobalMatch semiGlobalMatch(const CostVolume& volume) {
  const int levels = volume.levels;
  const std::size_t pixels = std::size_t(volume.width) * std::size_t(volume.height);
  std::vector<std::int16_t> sum(pixels * std::size_t(levels), 0);
  sweepOnce(volume, false, sum);
  sweepOnce(volume, true, sum);
  SemiGlobalMatch result{ImageF(volume.width, volume.height, 1), ImageF(volume.width, volume.height, 1)};
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::int16_t* const s = &sum[p * std::size_t(levels)];
    const int best = int(std::min_element(s, s + levels) - s);
    float level = float(best);
    if (best > 0 && best < levels - 1) {
      const int below = s[best - 1] - s[best], above = s[best + 1] - s[best];
      if (below + above > 0) level += 0.5f * float(below - above) / float(below + above);
    }
    result.level.values[p] = level;
    result.firstExcess.values[p] = float(s[0] - s[best]) / kDirections;
  }
  return result;
}

}  // namespace ibr
