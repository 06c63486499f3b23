// SPDX-License-Identifier: Apache-2.0
#include "ibr/metrics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "formula_pictures.h"
#include "ibr/error.h"

using namespace ibr;

namespace {

Image8 noise(int width, int height, int channels, std::uint32_t seed) {
  Image8 image(width, height, channels);
  std::mt19937 random(seed);
  for (auto& v : image.values) v = std::uint8_t(random());
  return image;
}

Image8 plus(Image8 image, int offset) {
  for (auto& v : image.values) v = std::uint8_t(v + offset);
  return image;
}

double grey(const Image8& image, int x, int y) {
  const auto p = image.pixel(x, y);
  return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

// Wang et al. 2004, eq. 13, window by window with two-dimensional weights and central moments.
double ssimByDefinition(const Image8& a, const Image8& b, const Image8* mask) {
  double sum = 0;
  int windows = 0;
  for (int y = 5; y + 5 < a.height; ++y)
    for (int x = 5; x + 5 < a.width; ++x) {
      double total = 0, meanA = 0, meanB = 0;
      bool inside = true;
      const auto weight = [](int i, int j) { return std::exp(-(i * i + j * j) / (2 * 1.5 * 1.5)); };
      const auto each = [&](auto&& f) {
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i) f(weight(i, j), x + i, y + j);
      };
      each([&](double w, int u, int v) {
        total += w;
        meanA += w * grey(a, u, v);
        meanB += w * grey(b, u, v);
        inside &= !mask || mask->pixel(u, v)[0] != 0;
      });
      if (!inside) continue;
      meanA /= total;
      meanB /= total;
      double varianceA = 0, varianceB = 0, covariance = 0;
      each([&](double w, int u, int v) {
        const double p = grey(a, u, v) - meanA, q = grey(b, u, v) - meanB;
        varianceA += w / total * p * p;
        varianceB += w / total * q * q;
        covariance += w / total * p * q;
      });
      const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
      sum += (2 * meanA * meanB + c1) * (2 * covariance + c2) /
             ((meanA * meanA + meanB * meanB + c1) * (varianceA + varianceB + c2));
      ++windows;
    }
  return sum / windows;
}

}  // namespace

TEST_CASE("PSNR is exact for known differences") {
  const Image8 a(20, 10, 3, 100);
  CHECK(psnr(a, a) == std::numeric_limits<double>::infinity());
  CHECK(psnr(a, plus(a, 1)) == Approx(48.1308036087));    // 20 log10 255
  CHECK(psnr(a, plus(a, -16)) == Approx(24.0484039560));  // 20 log10 (255 / 16)
  CHECK(psnr(Image8(4, 4, 3, 0), Image8(4, 4, 3, 255)) == Approx(0.0).margin(1e-12));
  Image8 one = a;
  one.pixel(3, 4)[1] = 200;  // one of 600 values differs by 100
  CHECK(psnr(a, one) == Approx(10 * std::log10(255.0 * 255.0 * 600 / 10000)));
}

TEST_CASE("PSNR ignores alpha and masked pixels") {
  Image8 a(6, 6, 4, 10), b(6, 6, 4, 10);
  for (int x = 0; x < 6; ++x) b.pixel(x, 0)[3] = 99;
  CHECK(psnr(a, b) == std::numeric_limits<double>::infinity());
  b.pixel(2, 2)[0] = 20;
  Image8 mask(6, 6, 1, 0);
  CHECK(std::isnan(psnr(a, b, mask)));
  mask.pixel(1, 1)[0] = 1;
  CHECK(psnr(a, b, mask) == std::numeric_limits<double>::infinity());
  mask.pixel(2, 2)[0] = 255;
  CHECK(psnr(a, b, mask) == Approx(10 * std::log10(255.0 * 255.0 * 6 / 100)));
  CHECK(psnr(a, noise(6, 6, 3, 1)) < 30);  // 3 channels may be compared with 4
}

TEST_CASE("SSIM follows its definition") {
  for (auto [width, height] : {std::pair{11, 11}, {17, 12}, {24, 31}}) {
    const Image8 a = noise(width, height, 3, 1), b = noise(width, height, 4, 2);
    CHECK(ssim(a, a) == 1.0);
    CHECK(ssim(a, b) == Approx(ssimByDefinition(a, b, nullptr)).epsilon(1e-9));
    Image8 close = a;
    for (std::size_t i = 0; i < close.values.size(); i += 7) close.values[i] ^= 24;
    CHECK(ssim(a, close) == Approx(ssimByDefinition(a, close, nullptr)).epsilon(1e-9));
    CHECK(ssim(a, close) == ssim(close, a));
  }
  // Constant pictures leave the luminance term only.
  const double c1 = 2.55 * 2.55;
  CHECK(ssim(Image8(12, 12, 3, 100), Image8(12, 12, 3, 120)) ==
        Approx((2 * 100 * 120 + c1) / (100 * 100 + 120 * 120 + c1)));
}

TEST_CASE("SSIM uses only windows that lie inside image and mask") {
  const Image8 a = noise(30, 25, 3, 1), b = noise(30, 25, 3, 2);
  Image8 mask(30, 25, 1, 255);
  CHECK(ssim(a, b, mask) == ssim(a, b));
  mask.pixel(14, 12)[0] = 0;
  mask.pixel(29, 3)[0] = 0;
  CHECK(ssim(a, b, mask) == Approx(ssimByDefinition(a, b, &mask)).epsilon(1e-9));
  // One valid window is left.
  Image8 single(30, 25, 1, 0);
  for (int y = 7; y < 18; ++y)
    for (int x = 9; x < 20; ++x) single.pixel(x, y)[0] = 1;
  CHECK(ssim(a, b, single) == Approx(ssimByDefinition(a, b, &single)).epsilon(1e-9));
  single.pixel(9, 7)[0] = 0;
  CHECK(std::isnan(ssim(a, b, single)));
  CHECK(std::isnan(ssim(noise(10, 40, 3, 1), noise(10, 40, 3, 2))));  // too small for a window
}

TEST_CASE("MS-SSIM follows its definition") {
  const Image8 a = blocks(190, 181, 16, 1);
  Image8 b = rolled(a);
  for (auto& v : b.values) v = std::uint8_t(0.75 * v + 32);
  CHECK(msSsim(a, a) == Approx(1.0).epsilon(1e-12));
  CHECK(msSsim(a, b) == msSsim(b, a));
  // Reference: NumPy with OpenCV's separable Gaussian in double precision, on the same pictures.
  CHECK(msSsim(a, b) == Approx(0.8940639711).epsilon(1e-6));
  // A difference in luminance alone counts at the coarsest scale only.
  const double c1 = 2.55 * 2.55;
  CHECK(msSsim(Image8(200, 180, 3, 100), Image8(200, 180, 3, 120)) ==
        Approx(std::pow((2 * 100 * 120 + c1) / (100 * 100 + 120 * 120 + c1), 0.1333)));
  // Fine noise lowers SSIM more than MS-SSIM.
  Image8 noisy = a, opposite = a;
  std::mt19937 random(3);
  for (auto& v : noisy.values) v = std::uint8_t(std::min(255, v / 2 + int(random() % 64)));
  for (auto& v : opposite.values) v = std::uint8_t(255 - v);
  CHECK(msSsim(a, noisy) > ssim(a, noisy));
  CHECK(msSsim(a, opposite) == 0.0);
}

TEST_CASE("MS-SSIM needs 11 pixels at its coarsest scale") {
  CHECK(msSsim(Image8(176, 176, 3, 7), Image8(176, 176, 3, 7)) == Approx(1.0));
  CHECK(std::isnan(msSsim(Image8(175, 400, 3, 7), Image8(175, 400, 3, 7))));
  CHECK(std::isnan(msSsim(Image8(400, 10, 3, 7), Image8(400, 10, 3, 7))));
  CHECK(std::isnan(msSsim(Image8(1, 1, 3, 7), Image8(1, 1, 3, 7))));
}

TEST_CASE("detail: blur lowers the energy, ghosts raise the energy and lower the correlation") {
  const Image8 truth = blocks(80, 64, 8, 5), all(80, 64, 1, 255);
  const auto mixed = [](const Image8& a, const Image8& b) {
    Image8 image = a;
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = std::uint8_t((a.values[i] + b.values[i]) / 2);
    return image;
  };
  CHECK(detail(truth, truth, all).energy == 1.0);
  CHECK(detail(truth, truth, all).correlation == Approx(1.0));
  const Image8 blurred = mixed(truth, rolled(truth));
  CHECK(detail(blurred, truth, all).energy < 0.85);
  // Adds bars that the true picture does not have.
  Image8 both = truth;
  for (int y = 0; y < both.height; ++y)
    for (int x = 0; x < both.width; x += 5)
      for (auto& v : both.pixel(x, y)) v = std::uint8_t(v ^ 128);
  CHECK(detail(both, truth, all).energy > 1.1);
  CHECK(detail(both, truth, all).correlation < 0.8);
  CHECK(detail(plus(Image8(80, 64, 3, 9), 3), truth, all).energy == 0.0);
  CHECK(detail(Image8(80, 64, 3, 9), truth, all).correlation == 0.0);
  Image8 opposite = truth;
  for (auto& v : opposite.values) v = std::uint8_t(255 - v);
  CHECK(detail(opposite, truth, all).energy == Approx(1.0));
  CHECK(detail(opposite, truth, all).correlation == Approx(-1.0));
}

TEST_CASE("sampled detail: noise loses two thirds between pixels, a ramp loses nothing") {
  Image8 noise(200, 200, 3), ramp(64, 8, 3), stripes(64, 8, 3);
  std::mt19937 random(3);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const auto level = std::uint8_t(random() % 256);
      for (auto& v : noise.pixel(x, y)) v = level;
    }
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 64; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        ramp.pixel(x, y)[c] = std::uint8_t(4 * x);
        stripes.pixel(x, y)[c] = std::uint8_t(255 * (x % 2));
      }
  // White noise: (1 − f)² + (1 − 2f)² + f² of 2 along an axis, (1 − f)² + f² across; mean over f = 1/8, 3/8, 5/8, 7/8.
  CHECK(sampledDetail(noise) == Approx(0.96875 / 2 * 0.65625).margin(0.005));
  CHECK(sampledDetail(ramp) == Approx(1.0));
  CHECK(sampledDetail(stripes) == Approx((0.75 * 0.75 + 0.25 * 0.25) / 2));  // (1 − 2f)²
  CHECK(std::isnan(sampledDetail(Image8(20, 20, 3, 7))));
  CHECK(std::isnan(sampledDetail(Image8(1, 1, 3, 7))));
}

TEST_CASE("detail counts only neighbours that are both inside the mask") {
  Image8 a(3, 1, 3, 0), b(3, 1, 3, 0);
  a.pixel(1, 0)[1] = 100, b.pixel(1, 0)[1] = 50;  // edges of 58.7 and 29.35 levels on both sides
  a.pixel(2, 0)[1] = 100;
  Image8 mask(3, 1, 1, 255);
  CHECK(detail(b, a, mask).energy == Approx(0.5));
  mask.pixel(2, 0)[0] = 0;
  CHECK(detail(b, a, mask).energy == Approx(0.25));
  CHECK(detail(b, a, mask).correlation == Approx(1.0));
  mask.pixel(1, 0)[0] = 0;
  CHECK(std::isnan(detail(b, a, mask).energy));
  CHECK(std::isnan(detail(Image8(1, 1, 3), Image8(1, 1, 3), Image8(1, 1, 1, 1)).correlation));
}

TEST_CASE("deltaE is exact for known colours") {
  const auto one = [](int r, int g, int b) {
    Image8 image(1, 1, 3);
    image.values = {std::uint8_t(r), std::uint8_t(g), std::uint8_t(b)};
    return image;
  };
  const Image8 all(1, 1, 1, 1), none(1, 1, 1, 0);
  CHECK(deltaE(one(0, 0, 0), one(255, 255, 255), all) == Approx(100).epsilon(1e-4));
  CHECK(deltaE(one(255, 0, 0), one(0, 255, 0), all) == Approx(170.57).epsilon(1e-3));
  CHECK(deltaE(one(3, 90, 200), one(3, 90, 200), all) == 0);
  CHECK(std::isnan(deltaE(one(0, 0, 0), one(1, 1, 1), none)));
}

TEST_CASE("difference counts pixels by their largest channel") {
  Image8 a(10, 10, 3, 50), b = a;
  b.pixel(0, 0)[0] = 60;
  b.pixel(0, 0)[2] = 47;
  b.pixel(5, 5)[1] = 46;
  const Difference at4 = difference(a, b, 4), at3 = difference(a, b, 3), at10 = difference(a, b, 10);
  CHECK(at4.largest == 10);
  CHECK(at4.meanAbsolute == Approx((10 + 3 + 4) / 300.0));
  CHECK(at4.shareAbove == Approx(0.01));
  CHECK(at3.shareAbove == Approx(0.02));
  CHECK(at10.shareAbove == 0.0);
}

TEST_CASE("metrics refuse images of different sizes, without colour, or with a wrong mask") {
  const Image8 a(12, 12, 3), small(12, 11, 3), greyOnly(12, 12, 1), mask(12, 12, 1), wideMask(13, 12, 1);
  CHECK_THROWS_AS(psnr(a, small), Error);
  CHECK_THROWS_AS(psnr(a, greyOnly), Error);
  CHECK_THROWS_AS(psnr(greyOnly, a), Error);
  CHECK_THROWS_AS(psnr(Image8(), Image8()), Error);
  CHECK_THROWS_AS(psnr(a, a, wideMask), Error);
  CHECK_THROWS_AS(psnr(a, a, a), Error);
  CHECK_THROWS_AS(ssim(a, small), Error);
  CHECK_THROWS_AS(ssim(a, a, wideMask), Error);
  CHECK_THROWS_AS(difference(a, small, 1), Error);
  CHECK_THROWS_AS(msSsim(a, small), Error);
  CHECK_THROWS_AS(msSsim(a, greyOnly), Error);
  CHECK_THROWS_AS(detail(a, small, mask), Error);
  CHECK_THROWS_AS(detail(a, a, wideMask), Error);
}

TEST_CASE("torn tiles are those with far more gradient than the truth") {
  const Image8 flat(80, 40, 3, 100);  // tiles of 32, 32 and 16 px across, 32 and 8 down
  CHECK(tornTiles(flat, flat) == 0);
  Image8 torn = flat;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; x += 2)
      for (std::size_t c = 0; c < 3; ++c) torn.pixel(x, y)[c] = 110;
  CHECK(tornTiles(torn, flat) == Approx(1.0 / 6));
  CHECK(tornTiles(torn, torn) == 0);
  CHECK(tornTiles(flat, torn) == 0);  // blur does not count as tearing
  Image8 slight = flat;               // a gradient of 4 levels² above the truth's is tolerated
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 80; x += 2)
      for (std::size_t c = 0; c < 3; ++c) slight.pixel(x, y)[c] = 101;
  CHECK(tornTiles(slight, flat) == 0);
}

TEST_CASE("the worst tile has the largest mean squared error, also if the tile is small") {
  const Image8 truth(70, 64, 3, 100);
  Image8 picture = truth;
  picture.pixel(3, 3)[0] = 200;
  CHECK(worstTile(picture, truth).x == 0);
  for (int y = 32; y < 64; ++y) picture.pixel(66, y)[1] = 130;
  const WorstTile worst = worstTile(picture, truth);
  CHECK(worst.x == 64);
  CHECK(worst.y == 32);
  CHECK(worst.meanSquared == Approx(32 * 900.0 / (3 * 6 * 32)));
  CHECK(worstTile(truth, truth).meanSquared == 0);
}
