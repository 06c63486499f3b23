// SPDX-License-Identifier: Apache-2.0
#include "author/depth/sky.h"

#include <cstdint>
#include <vector>

namespace ibr {
namespace {

constexpr float kMaxExcess = 50;                // max excess of infinity, path costs …
constexpr float kMaxExcessUnmatched = 150;      // … and where no depth matches:
constexpr std::uint8_t kUnmatchedCost = 75;     // at this cost and above
constexpr int kSkyMarginPx = 2;                 // px, distance from pixels that are not sky
constexpr int kMinRegionPx = 400;               // min px of a region
constexpr float kMaxCertainExcess = 3;          // excess up to which infinity is as good as any depth …
constexpr double kMinCertainShare = 0.02;       // … for at least this share of a region at the upper border, …
constexpr double kMinCertainShareInside = 0.5;  // … and of an inner region, cut off by a wire or a mast

template <class Visit>
void forNeighbours(int at, int width, int height, Visit&& visit) {
  const int x = at % width, y = at / width;
  if (x > 0) visit(std::size_t(at - 1));
  if (x + 1 < width) visit(std::size_t(at + 1));
  if (y > 0) visit(std::size_t(at - width));
  if (y + 1 < height) visit(std::size_t(at + width));
}

std::vector<bool> candidates(const ImageF& infinityExcess, const Image8& cost) {
  std::vector<bool> may(cost.values.size());
  for (std::size_t p = 0; p < may.size(); ++p)
    may[p] = infinityExcess.values[p] <= (cost.values[p] >= kUnmatchedCost ? kMaxExcessUnmatched : kMaxExcess);
  for (int round = 0; round < kSkyMarginPx; ++round) {
    const std::vector<bool> before = may;
    for (std::size_t p = 0; p < may.size(); ++p)
      forNeighbours(int(p), cost.width, cost.height, [&](std::size_t q) {
        if (!before[q]) may[p] = false;
      });
  }
  return may;
}

}  // namespace

Image8 skyOf(const ImageF& infinityExcess, const Image8& cost) {
  const int width = cost.width, height = cost.height;
  const std::vector<bool> may = candidates(infinityExcess, cost);
  Image8 sky(width, height, 1, 0);
  std::vector<bool> seen(may.size(), false);
  std::vector<std::size_t> region;
  for (std::size_t start = 0; start < may.size(); ++start) {
    if (!may[start] || seen[start]) continue;
    seen[start] = true;
    region.assign(1, start);
    bool reachesTop = false;
    std::size_t certain = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      reachesTop = reachesTop || region[k] < std::size_t(width);
      certain += infinityExcess.values[region[k]] <= kMaxCertainExcess;
      forNeighbours(int(region[k]), width, height, [&](std::size_t q) {
        if (!may[q] || seen[q]) return;
        seen[q] = true;
        region.push_back(q);
      });
    }
    const double least = reachesTop ? kMinCertainShare : kMinCertainShareInside;
    if (region.size() >= std::size_t(kMinRegionPx) && double(certain) >= least * double(region.size()))
      for (const std::size_t at : region) sky.values[at] = 255;
  }
  return sky;
}

}  // namespace ibr
