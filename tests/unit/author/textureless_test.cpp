// SPDX-License-Identifier: Apache-2.0
#include "author/textureless.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace ibr;

namespace {

constexpr int kSize = 40, kLevels = 20;

// A flat square in the middle that no level explains better, in textured surroundings; levels all `level`.
bool inSquare(int x, int y, int margin = 0) {
  const int low = 10 + margin, high = 30 - margin;
  return x >= low && x < high && y >= low && y < high;
}
struct Sweep {
  CostVolume volume;
  ImageF level;
};
Sweep makeSweep(float level) {
  Sweep sweep{{kSize, kSize, kLevels, {}, ImageF(kSize, kSize, 1)}, ImageF(kSize, kSize, 1, level)};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      sweep.volume.guide.pixel(x, y)[0] = inSquare(x, y) ? 200.0f : float(50 + 37 * ((x / 2 + y / 2) % 3));
      for (int l = 0; l < kLevels; ++l)
        sweep.volume.cost.push_back(inSquare(x, y) ? 120 : std::uint8_t(l == int(level) ? 10 : 120));
    }
  return sweep;
}

}  // namespace

TEST_CASE("a flat region whose border lies on several surfaces is behind all of them") {
  constexpr int kMargin = 4;  // the picture's windows look as far as that beyond it
  Sweep sweep = makeSweep(12);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      if (!inSquare(x, y, kMargin)) sweep.level.pixel(x, y)[0] = float(6 + 6 * ((7 * x + 5 * y + x * y / 3) % 3));
  const ImageF before = sweep.level;
  settleTextureless(sweep.level, sweep.volume);
  CHECK(sweep.level.pixel(20, 20)[0] == 6.0f);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      if (!inSquare(x, y)) CHECK(sweep.level.pixel(x, y)[0] == before.pixel(x, y)[0]);
      CHECK(sweep.level.pixel(x, y)[0] <= before.pixel(x, y)[0]);
    }
}

TEST_CASE("a flat part of a surface stays on it; one that is all but at infinity goes there") {
  Sweep wall = makeSweep(12);
  const ImageF before = wall.level;
  settleTextureless(wall.level, wall.volume);
  CHECK(wall.level == before);

  Sweep sky = makeSweep(2);
  settleTextureless(sky.level, sky.volume);
  CHECK(sky.level.pixel(20, 20)[0] == 0.0f);
  CHECK(sky.level.pixel(2, 2)[0] == 2.0f);
}

TEST_CASE("where some level is clearly better than infinity nothing is changed") {
  Sweep sweep = makeSweep(12);
  for (std::size_t p = 0; p < sweep.level.values.size(); ++p) sweep.volume.cost[p * kLevels + 12] = 20;
  for (int x = 0; x < kSize; ++x) sweep.level.pixel(x, 5)[0] = 0;
  const ImageF before = sweep.level;
  settleTextureless(sweep.level, sweep.volume);
  CHECK(sweep.level == before);
}
