// SPDX-License-Identifier: Apache-2.0
// Alignments with a known solution: one smooth random texture, shifted in each picture, and a mesh with wrong matches.
#pragma once

#include <random>

#include "ibr/optimiser.h"

namespace ibr::test {

struct Planted {
  std::vector<Image8> pictures;
  Alignment alignment;            // points at `pictures`
  std::vector<glm::dvec2> shift;  // d: shift of the texture in a picture, px relative to picture 0

  Planted() = default;
  Planted(Planted&&) = default;  // moving keeps the pictures' addresses
  Planted(const Planted&) = delete;
};

/// Builds `members` pictures of side × side px and a grid of cells × cells squares. In all but the first picture, inner
/// points are off by up to offPx in x and in y. Border points are exact.
Planted planted(int members, int side, int cells, double offPx, std::uint32_t seed);

/// Mean and maximum distance, px, between a point's positions in two pictures after their shift; inner points only.
struct MatchError {
  double mean = 0, largest = 0;
};
MatchError matchError(const Planted& planted);

}  // namespace ibr::test
