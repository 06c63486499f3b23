// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/colour_scores.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/metrics.h"

using namespace ibr;
using namespace ibr::app;

namespace {

// An image of 4 × 2 pixels whose halves have one grey level each.
Image8 halves(int left, int right) {
  Image8 image(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (std::size_t c = 0; c < 3; ++c) image.pixel(x, y)[c] = std::uint8_t(x < 2 ? left : right);
  return image;
}

// Surface buffer: the left half shows the best cell, the right half the second.
ImageF twoCells() {
  ImageF surface(4, 2, 4);
  for (int y = 0; y < 2; ++y)
    for (int x = 2; x < 4; ++x) surface.pixel(x, y)[2] = 1;
  return surface;
}

}  // namespace

TEST_CASE("a seam is the colour step between cells minus that of the truth") {
  const Image8 picture = halves(100, 130), truth = halves(100, 110);
  const SeamStep found = seamStep(picture, twoCells(), truth);
  CHECK(found.levels == Approx(20));
  CHECK(found.deltaE ==
        Approx(deltaE(picture.pixel(1, 0), picture.pixel(2, 0)) - deltaE(truth.pixel(1, 0), truth.pixel(2, 0))));
  CHECK(found.deltaE == Approx(8).margin(1));  // 2.55 grey levels are about one unit of L*
  CHECK(seamStep(truth, twoCells(), truth).levels == 0);
  CHECK(seamStep(truth, twoCells(), truth).deltaE == 0);
}

TEST_CASE("without a border between cells of tier 0 there is no seam") {
  const Image8 picture = halves(100, 130);
  const ImageF oneCell(4, 2, 4);
  CHECK(std::isnan(seamStep(picture, oneCell, picture).levels));
  ImageF completed = twoCells();
  for (int y = 0; y < 2; ++y)
    for (int x = 2; x < 4; ++x) completed.pixel(x, y)[1] = 2;
  CHECK(std::isnan(seamStep(picture, completed, picture).deltaE));
}
