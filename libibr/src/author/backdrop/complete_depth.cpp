// SPDX-License-Identifier: Apache-2.0
// Solves coarse to fine: each level starts from the next coarser one and is relaxed by Gauss–Seidel.
#include "author/backdrop/complete_depth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace ibr {
namespace {

constexpr int kSweeps = 12;           // pairs of forward and backward sweeps per level
constexpr float kColourScale = 6.0f;  // change of colour at which the conductance falls to 1/e, 8-bit levels
constexpr float kMinConductance = 1e-3f;

struct Level {
  int width, height;
  std::vector<float> value;  // ρ
  std::vector<float> known;  // known share of the pixel's area; the value is fixed if > 0
  ImageF colour;

  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

Level halved(const Level& fine) {
  Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}, {}};
  const std::size_t count = std::size_t(coarse.width) * std::size_t(coarse.height);
  coarse.value.assign(count, 0.0f);
  coarse.known.assign(count, 0.0f);
  coarse.colour = ImageF(coarse.width, coarse.height, 3);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      const std::size_t to = coarse.at(x, y);
      float pixels = 0;
      for (int v = 2 * y; v <= std::min(2 * y + 1, fine.height - 1); ++v)
        for (int u = 2 * x; u <= std::min(2 * x + 1, fine.width - 1); ++u) {
          const std::size_t from = fine.at(u, v);
          ++pixels;
          coarse.value[to] += fine.known[from] * fine.value[from];
          coarse.known[to] += fine.known[from];
          for (std::size_t c = 0; c < 3; ++c) coarse.colour.values[3 * to + c] += fine.colour.values[3 * from + c];
        }
      if (coarse.known[to] > 0) coarse.value[to] /= coarse.known[to];
      coarse.known[to] /= pixels;
      for (std::size_t c = 0; c < 3; ++c) coarse.colour.values[3 * to + c] /= pixels;
    }
  return coarse;
}

float conductance(const ImageF& colour, std::size_t a, std::size_t b) {
  float change = 0;
  for (std::size_t c = 0; c < 3; ++c)
    change = std::max(change, std::abs(colour.values[3 * a + c] - colour.values[3 * b + c]));
  return std::max(std::exp(-change / kColourScale), kMinConductance);
}

void relax(Level& level) {
  const int width = level.width, height = level.height;
  std::vector<float> right(level.value.size(), 0.0f), below(level.value.size(), 0.0f);
  std::vector<std::size_t> open;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = level.at(x, y);
      if (x + 1 < width) right[at] = conductance(level.colour, at, at + 1);
      if (y + 1 < height) below[at] = conductance(level.colour, at, at + std::size_t(width));
      if (level.known[at] <= 0) open.push_back(at);
    }
  const auto row = std::size_t(width);
  const auto update = [&](std::size_t at) {
    float sum = 0, weight = 0;
    const auto add = [&](float share, std::size_t from) {
      sum += share * level.value[from];
      weight += share;
    };
    // Conductances across the image border are 0.
    if (at % row != 0) add(right[at - 1], at - 1);
    if (right[at] > 0) add(right[at], at + 1);
    if (at >= row) add(below[at - row], at - row);
    if (below[at] > 0) add(below[at], at + row);
    if (weight > 0) level.value[at] = sum / weight;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (auto at = open.begin(); at != open.end(); ++at) update(*at);
    for (auto at = open.rbegin(); at != open.rend(); ++at) update(*at);
  }
}

// Clamps each connected region without depth to the range of the known values around it.
void clampToRims(const ImageF& known, ImageF& completed) {
  const int width = known.width, height = known.height;
  std::vector<bool> seen(known.values.size(), false);
  std::vector<int> region;
  for (int seed = 0; seed < width * height; ++seed) {
    if (seen[std::size_t(seed)] || known.values[std::size_t(seed)] >= 0) continue;
    seen[std::size_t(seed)] = true;
    region.assign(1, seed);
    float low = std::numeric_limits<float>::infinity(), high = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      const int at = region[k], x = at % width, y = at / width;
      const auto visit = [&](int to) {
        if (const float value = known.values[std::size_t(to)]; value >= 0) {
          low = std::min(low, value);
          high = std::max(high, value);
        } else if (!seen[std::size_t(to)]) {
          seen[std::size_t(to)] = true;
          region.push_back(to);
        }
      };
      if (x > 0) visit(at - 1);
      if (x + 1 < width) visit(at + 1);
      if (y > 0) visit(at - width);
      if (y + 1 < height) visit(at + width);
    }
    for (const int at : region)
      completed.values[std::size_t(at)] = std::clamp(completed.values[std::size_t(at)], std::min(low, high), high);
  }
}

}  // namespace

ImageF completeDepth(const ImageF& inverseDepth, const Image8& colours) {
  ImageF result(inverseDepth.width, inverseDepth.height, 1);
  if (std::ranges::none_of(inverseDepth.values, [](float w) { return w >= 0; })) return result;

  std::vector<Level> levels(1);
  Level& finest = levels[0];
  finest.width = inverseDepth.width;
  finest.height = inverseDepth.height;
  finest.colour = ImageF(inverseDepth.width, inverseDepth.height, 3);
  std::copy(colours.values.begin(), colours.values.end(), finest.colour.values.begin());
  for (const float w : inverseDepth.values) {
    finest.known.push_back(w >= 0 ? 1.0f : 0.0f);
    finest.value.push_back(std::max(w, 0.0f));
  }
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(halved(levels.back()));
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    const Level& coarse = levels[l + 1];
    Level& level = levels[l];
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x)
        if (level.known[level.at(x, y)] <= 0) level.value[level.at(x, y)] = coarse.value[coarse.at(x / 2, y / 2)];
    relax(level);
  }
  for (std::size_t at = 0; at < result.values.size(); ++at)
    result.values[at] = inverseDepth.values[at] >= 0 ? inverseDepth.values[at] : levels[0].value[at];
  clampToRims(inverseDepth, result);
  return result;
}

}  // namespace ibr
