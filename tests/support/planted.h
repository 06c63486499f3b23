// SPDX-License-Identifier: Apache-2.0
// An alignment whose truth is known: one smooth random texture seen shifted, and a mesh whose matches are off.
#pragma once

#include <random>

#include "ibr/optimiser.h"

namespace ibr::test {

struct Planted {
  std::vector<Image8> pictures;
  Alignment alignment;            // points at `pictures`
  std::vector<glm::dvec2> shift;  // d: where a point of the texture is seen in a picture, px from picture 0

  Planted() = default;
  Planted(Planted&&) = default;  // the pictures stay where they are
  Planted(const Planted&) = delete;
};

/// `members` pictures of side px, a grid of cells × cells squares; the points of all but the first picture are off by
/// up to offPx each way, those of the border are not.
Planted planted(int members, int side, int cells, double offPx, std::uint32_t seed);

/// Mean and largest distance, px, between two pictures' positions of a point beyond their shift; inner points only.
struct MatchError {
  double mean = 0, largest = 0;
};
MatchError matchError(const Planted& planted);

}  // namespace ibr::test
