// SPDX-License-Identifier: Apache-2.0
#include "image/sharpness.h"

#include <algorithm>
#include <array>
#include <limits>

namespace ibr {
namespace {

constexpr int kLeastSide = 8;
constexpr double kFlat = 1e-3;  // grey levels²; an image below shows nothing

using Directions = std::array<double, 4>;

Directions meanSquaredSecondDifferences(const Image8& picture) {
  const std::size_t channel = picture.channels > 1 ? 1 : 0;
  const auto value = [&](int x, int y) { return int(picture.pixel(x, y)[channel]); };
  Directions sums{};
  for (int y = 1; y + 1 < picture.height; ++y)
    for (int x = 1; x + 1 < picture.width; ++x) {
      const int twice = 2 * value(x, y);
      const int found[] = {value(x - 1, y) + value(x + 1, y) - twice, value(x, y - 1) + value(x, y + 1) - twice,
                           value(x - 1, y - 1) + value(x + 1, y + 1) - twice,
                           value(x + 1, y - 1) + value(x - 1, y + 1) - twice};
      for (std::size_t d = 0; d < 4; ++d) sums[d] += double(found[d]) * found[d];
    }
  for (double& sum : sums) sum /= double(picture.width - 2) * (picture.height - 2);
  return sums;
}

}  // namespace

double sharpness(const Image8& picture, const Image8& eighth) {
  if (std::min(eighth.width, eighth.height) < kLeastSide) return std::numeric_limits<double>::quiet_NaN();
  const Directions fine = meanSquaredSecondDifferences(picture), coarse = meanSquaredSecondDifferences(eighth);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t d = 0; d < 4; ++d) least = std::min(least, fine[d] / std::max(kFlat, coarse[d]));
  return least;
}

}  // namespace ibr
