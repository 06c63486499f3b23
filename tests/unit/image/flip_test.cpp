// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "formula_pictures.h"
#include "ibr/error.h"
#include "ibr/metrics.h"
#include "support/extremes.h"

using namespace ibr;

namespace {

Image8 flat(int width, int height, int r, int g, int b) {
  Image8 image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto p = image.pixel(x, y);
      p[0] = std::uint8_t(r), p[1] = std::uint8_t(g), p[2] = std::uint8_t(b);
    }
  return image;
}

// Grey picture of stripes and blobs, with noise of `noise` 8-bit levels.
Image8 scene(int width, int height, double noise, std::uint32_t seed = 1) {
  Image8 image(width, height, 3);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = 128 + 50 * std::sin(0.2 * x) + 30 * std::cos(0.13 * (x + y) + double(c));
        image.pixel(x, y)[c] = std::uint8_t(std::clamp(value + noise * normal(random), 0.0, 255.0));
      }
  return image;
}

float largest(const ImageF& map) {
  return *std::max_element(map.values.begin(), map.values.end());
}

}  // namespace

TEST_CASE("FLIP of flat images follows from their colours") {
  // HyAB of black and white is 100, of green and blue 203.3 after the Hunt effect; without features no term is added.
  const auto of = [](const Image8& a, const Image8& b) { return flip(a, b); };
  const Image8 black = flat(40, 30, 0, 0, 0), white = flat(40, 30, 255, 255, 255);
  const double knee = 0.4 * std::pow(203.3, 0.7), c = std::pow(100.0, 0.7);
  CHECK(of(black, white) == Approx(0.95 + 0.05 * (c - knee) / (1.5 * knee)).epsilon(1e-3));
  CHECK(of(flat(40, 30, 0, 255, 0), flat(40, 30, 0, 0, 255)) == Approx(1.0).epsilon(1e-5));
  CHECK(of(black, black) == 0.0);
  // For greys only lightness differs. CIE L* of level 100 is 42.37, of level 120 50.43.
  const double between = 50.434 - 42.375;
  CHECK(of(flat(40, 30, 100, 100, 100), flat(40, 30, 120, 120, 120)) ==
        Approx(0.95 / knee * std::pow(between, 0.7)).epsilon(1e-3));
  // A larger offset gives a larger error, equal in all pixels.
  double before = 0;
  for (const int offset : {1, 2, 5, 20, 80}) {
    const ImageF map = flipMap(flat(20, 20, 90, 90, 90), flat(20, 20, 90 + offset, 90 + offset, 90 + offset));
    CHECK(largest(map) > before);
    CHECK(largest(map) == Approx(*std::min_element(map.values.begin(), map.values.end())).epsilon(1e-4));
    before = largest(map);
  }
}

TEST_CASE("FLIP follows its authors' formulas") {
  // Reference: NumPy in double precision with two-dimensional kernels and the constants of the authors' program.
  const Image8 a = ramp(96, 64, 2, 1, 40), b = ramp(96, 64, 2, 1, 55);
  CHECK(flip(a, b) == Approx(0.5343636803).epsilon(2e-4));
  CHECK(flip(a, b, 30) == Approx(0.5003503904).epsilon(2e-4));
  const Image8 c = blocks(96, 64, 8, 1);
  CHECK(flip(c, blocks(96, 64, 8, 2)) == Approx(0.6876422686).epsilon(2e-4));
  CHECK(flip(c, blocks(96, 64, 8, 2), 30) == Approx(0.7167801859).epsilon(2e-4));
  CHECK(flip(c, rolled(c)) == Approx(0.2054815137).epsilon(2e-4));
  CHECK(flip(c, rolled(c), 30) == Approx(0.1748741696).epsilon(2e-4));
}

TEST_CASE("FLIP is symmetric, 0 for equal images, within 0 and 1, and grows with noise") {
  const Image8 clean = scene(64, 48, 0);
  CHECK(flip(clean, clean) == 0.0);
  double before = 0;
  for (const double noise : {2.0, 5.0, 12.0, 30.0, 80.0}) {
    const Image8 noisy = scene(64, 48, noise);
    const ImageF map = flipMap(clean, noisy);
    const double value = flip(clean, noisy);
    CHECK(value > before);
    CHECK(value == flip(noisy, clean));
    CHECK(largest(map) <= 1.0f);
    CHECK(*std::min_element(map.values.begin(), map.values.end()) >= 0.0f);
    before = value;
  }
}

TEST_CASE("FLIP weights fine detail less, and edges more than flat differences") {
  // A chequerboard of single pixels against its mean: the difference shrinks with the viewing distance.
  Image8 fine(80, 80, 3), grey = flat(80, 80, 188, 188, 188);  // 188: half the light
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x)
      for (std::size_t c = 0; c < 3; ++c) fine.pixel(x, y)[c] = (x + y) % 2 ? 255 : 0;
  CHECK(flip(fine, grey, 120) < flip(fine, grey, 30));
  // A dark line has an edge; a small offset of the whole picture has none.
  Image8 line = flat(81, 81, 150, 150, 150), even = flat(81, 81, 150, 150, 150), none = even;
  for (int y = 0; y < 81; ++y)
    for (std::size_t c = 0; c < 3; ++c) line.pixel(40, y)[c] = 110;
  for (auto& v : even.values) v = std::uint8_t(v - 5);
  const ImageF atLine = flipMap(line, none), everywhere = flipMap(even, none);
  CHECK(atLine.pixel(40, 40)[0] > 2 * everywhere.pixel(40, 40)[0]);
  CHECK(atLine.pixel(5, 40)[0] == Approx(0.0).margin(1e-3));  // no difference far from the line
}

TEST_CASE("FLIP accepts tiny images and ignores alpha") {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {3, 2}}) {
    const Image8 a = flat(width, height, 10, 200, 30), b = flat(width, height, 12, 90, 30);
    const double value = flip(a, b);
    CHECK(value == Approx(flip(flat(50, 50, 10, 200, 30), flat(50, 50, 12, 90, 30))).epsilon(1e-4));
    CHECK(flip(a, a) == 0.0);
    for (const double perDegree : {1.0, 1000.0 / 8}) CHECK(std::isfinite(flip(a, b, perDegree)));
  }
  Image8 rgba(6, 6, 4, 100), rgb(6, 6, 3, 100);
  rgba.pixel(2, 2)[3] = 0;
  CHECK(flip(rgba, rgb) == 0.0);
}

TEST_CASE("FLIP refuses images of different sizes or without colour") {
  const Image8 a(12, 12, 3), small(12, 11, 3), greyOnly(12, 12, 1);
  CHECK_THROWS_AS(flip(a, small), Error);
  CHECK_THROWS_AS(flip(a, greyOnly), Error);
  CHECK_THROWS_AS(flip(greyOnly, a), Error);
  CHECK_THROWS_AS(flip(Image8(), Image8()), Error);
  for (const double perDegree : {0.0, -1.0, 1e9, std::nan("")}) CHECK_THROWS_AS(flip(a, a, perDegree), Error);
}

TEST_CASE("FLIP refuses extreme numbers of pixels per degree, and is otherwise within 0 and 1", "[N16]") {
  Image8 a(16, 16, 3, 40), b(16, 16, 3, 200);
  for (const double pixels : test::kExtremes) {
    INFO(pixels);
    CHECK_THROWS_AS(flip(a, b, pixels), Error);
  }
  for (const double pixels : {1.0, 1000.0}) CHECK((flip(a, b, pixels) > 0 && flip(a, b, pixels) <= 1));
}
