// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/colour_scores.h"

#include <cmath>

#include "ibr/metrics.h"
#include "ibr/view_scores.h"

namespace ibr::app {
namespace {

double step(const Image8& image, int x, int y, int dx, int dy) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::abs(image.pixel(x, y)[c] - image.pixel(x + dx, y + dy)[c]);
  return sum / 3;
}

}  // namespace

SeamStep seamStep(const Image8& picture, const ImageF& surface, const Image8& truth) {
  double levels = 0, deltas = 0;
  std::size_t count = 0;
  const auto add = [&](int x, int y, int dx, int dy) {
    const auto here = surface.pixel(x, y), there = surface.pixel(x + dx, y + dy);  // channels: depth, tier, rank, …
    if (here[1] != 0 || there[1] != 0 || here[2] == there[2]) return;
    levels += step(picture, x, y, dx, dy) - step(truth, x, y, dx, dy);
    deltas += deltaE(picture.pixel(x, y), picture.pixel(x + dx, y + dy)) -
              deltaE(truth.pixel(x, y), truth.pixel(x + dx, y + dy));
    ++count;
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      if (x + 1 < picture.width) add(x, y, 1, 0);
      if (y + 1 < picture.height) add(x, y, 0, 1);
    }
  if (count == 0) return {};
  return {levels / double(count), deltas / double(count)};
}

double gainFreeDeltaE(const Image8& picture, const Image8& truth, const Image8& mask) {
  return deltaE(gainFitted(picture, truth, mask), truth, mask);
}

}  // namespace ibr::app
