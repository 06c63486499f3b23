// SPDX-License-Identifier: Apache-2.0
#include "image/blue_noise.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using ibr::blueNoise;

TEST_CASE("every rank occurs exactly once") {
  for (int size : {8, 16, 64}) {
    std::vector<std::uint16_t> ranks = blueNoise(size, 1), expected(ranks.size());
    std::iota(expected.begin(), expected.end(), std::uint16_t(0));
    std::sort(ranks.begin(), ranks.end());
    CHECK(ranks == expected);
  }
}

TEST_CASE("blue noise is deterministic for a seed") {
  CHECK(blueNoise(16, 3) == blueNoise(16, 3));
  CHECK(blueNoise(16, 3) != blueNoise(16, 4));
}

TEST_CASE("thresholded noise has no low frequencies, also across the tile's border") {
  // Variance over blocks of 8×8 px (shifted by half a block) of the number of a level set's points in a block. White
  // noise has a variance of p(1−p)·n; blue noise has far less.
  const int size = 64, block = 8;
  const auto ranks = blueNoise(size, 1);
  for (double share : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    double variance = 0;
    const double expected = share * block * block;
    for (int by = 0; by < size; by += block)
      for (int bx = 0; bx < size; bx += block) {
        int count = 0;
        for (int y = 0; y < block; ++y)
          for (int x = 0; x < block; ++x)
            count += ranks[std::size_t((by + y + block / 2) % size * size + (bx + x + block / 2) % size)] <
                     share * size * size;
        variance += (count - expected) * (count - expected);
      }
    variance /= (size / block) * (size / block);
    INFO(share);
    CHECK(variance < 0.3 * share * (1 - share) * block * block);
  }
}
