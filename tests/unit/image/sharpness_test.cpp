// SPDX-License-Identifier: Apache-2.0
#include "ibr/metrics.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "ibr/texture.h"

using namespace ibr;

namespace {

// Overlapping squares of many sizes, RGBA.
Image8 scribble(int side, unsigned seed) {
  std::mt19937 random(seed);
  Image8 picture(side, side, 4, 255);
  for (int square = 0; square < 400; ++square) {
    const int size = 2 + int(random() % unsigned(side / 4)), left = int(random() % unsigned(side)),
              top = int(random() % unsigned(side));
    const auto value = std::uint8_t(random() % 256);
    for (int y = top; y < std::min(side, top + size); ++y)
      for (int x = left; x < std::min(side, left + size); ++x) std::fill_n(picture.pixel(x, y).begin(), 3, value);
  }
  return picture;
}

// Motion blur: the mean of `count` pixels along (dx, dy).
Image8 moved(const Image8& picture, int dx, int dy, int count) {
  Image8 blurred = picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        int sum = 0;
        for (int i = 0; i < count; ++i)
          sum += picture.pixel(std::clamp(x + i * dx, 0, picture.width - 1),
                               std::clamp(y + i * dy, 0, picture.height - 1))[c];
        blurred.pixel(x, y)[c] = std::uint8_t(sum / count);
      }
  return blurred;
}

double sharpnessOf(const Image8& picture) {
  return sharpness(picture, buildMips(picture)[3]);
}

}  // namespace

TEST_CASE("motion blur in any direction lowers sharpness, and more so for a longer motion") {
  for (const unsigned seed : {1u, 2u}) {
    const Image8 sharp = scribble(256, seed);
    const double as = sharpnessOf(sharp);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
      INFO(dx << " " << dy);
      const double little = sharpnessOf(moved(sharp, dx, dy, 2)), much = sharpnessOf(moved(sharp, dx, dy, 8));
      CHECK(little < 0.8 * as);
      CHECK(much < 0.25 * as);
      CHECK(much < little);
    }
    CHECK(sharpnessOf(moved(moved(sharp, 1, 0, 4), 0, 1, 4)) < 0.15 * as);
  }
}

TEST_CASE("contrast and rotation do not change sharpness") {
  const Image8 sharp = scribble(256, 3);
  Image8 dim = sharp, turned = sharp;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        dim.pixel(x, y)[c] = std::uint8_t(60 + sharp.pixel(x, y)[c] / 2);
        turned.pixel(255 - y, x)[c] = sharp.pixel(x, y)[c];
      }
  CHECK(sharpnessOf(dim) == Approx(sharpnessOf(sharp)).epsilon(0.1));  // mips are computed in linear light
  CHECK(sharpnessOf(turned) == Approx(sharpnessOf(sharp)).epsilon(1e-9));
}

TEST_CASE("a flat image has sharpness 0, and a tiny image NaN") {
  CHECK(sharpnessOf(Image8(128, 128, 4, 90)) == 0);
  CHECK(std::isnan(sharpness(Image8(63, 63, 4), Image8(7, 7, 4))));
  CHECK(std::isnan(sharpness(Image8(), Image8())));
  CHECK(std::isfinite(sharpness(Image8(64, 64, 1), Image8(8, 8, 1))));
}
