// SPDX-License-Identifier: Apache-2.0
#include "ibr/texture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "ibr/error.h"

using namespace ibr;

namespace {

double light(double encoded) {
  const double v = encoded / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

Image8 noise(int width, int height, int channels) {
  Image8 image(width, height, channels);
  std::mt19937 random(7);
  for (auto& v : image.values) v = std::uint8_t(random());
  return image;
}

// Box filter by definition, in doubles: each input pixel is spread over the output pixels that it overlaps.
std::vector<double> halvedByArea(const std::vector<double>& in, int width, int height, int outWidth, int outHeight) {
  std::vector<double> out(std::size_t(outWidth * outHeight), 0.0);
  for (int v = 0; v < outHeight; ++v)
    for (int u = 0; u < outWidth; ++u) {
      const double x0 = double(u) * width / outWidth, x1 = double(u + 1) * width / outWidth;
      const double y0 = double(v) * height / outHeight, y1 = double(v + 1) * height / outHeight;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const double wide = std::min(x1, x + 1.0) - std::max(x0, double(x));
          const double high = std::min(y1, y + 1.0) - std::max(y0, double(y));
          if (wide > 0 && high > 0) out[std::size_t(v * outWidth + u)] += wide * high * in[std::size_t(y * width + x)];
        }
      out[std::size_t(v * outWidth + u)] /= (x1 - x0) * (y1 - y0);
    }
  return out;
}

}  // namespace

TEST_CASE("levels halve, rounded down, until one pixel is left") {
  const auto levels = buildMips(noise(37, 10, 3));
  const std::vector<std::pair<int, int>> sizes{{37, 10}, {18, 5}, {9, 2}, {4, 1}, {2, 1}, {1, 1}};
  REQUIRE(levels.size() == sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    CHECK(levels[i].width == sizes[i].first);
    CHECK(levels[i].height == sizes[i].second);
    CHECK(levels[i].channels == 4);
  }
  CHECK(buildMips(noise(1, 1, 4)).size() == 1);
  CHECK(buildMips(noise(1, 4, 3)).size() == 3);
}

TEST_CASE("a constant image stays constant at all levels, for every value") {
  for (int v = 0; v < 256; ++v)
    for (const Image8& level : buildMips(Image8(7, 6, 4, std::uint8_t(v))))
      for (std::uint8_t value : level.values) REQUIRE(value == v);
}

TEST_CASE("level 0 is the image itself") {
  const Image8 rgba = noise(5, 3, 4);
  CHECK(buildMips(rgba)[0] == rgba);
  const Image8 rgb = noise(5, 3, 3), first = buildMips(rgb)[0];
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      for (std::size_t c = 0; c < 3; ++c) CHECK(first.pixel(x, y)[c] == rgb.pixel(x, y)[c]);
      CHECK(first.pixel(x, y)[3] == 255);
    }
}

TEST_CASE("every level is the area average of linear light, within half an 8-bit level") {
  for (auto [width, height] : {std::pair{16, 16}, {17, 16}, {16, 9}, {33, 21}, {1, 13}, {31, 1}, {3, 3}}) {
    const Image8 image = noise(width, height, 4);
    const auto levels = buildMips(image);
    for (int channel = 0; channel < 4; ++channel) {
      const bool colour = channel < 3;
      std::vector<double> exact;
      for (std::size_t i = std::size_t(channel); i < image.values.size(); i += 4)
        exact.push_back(colour ? light(image.values[i]) : image.values[i] / 255.0);
      for (std::size_t l = 1; l < levels.size(); ++l) {
        exact = halvedByArea(exact, levels[l - 1].width, levels[l - 1].height, levels[l].width, levels[l].height);
        for (std::size_t p = 0; p < exact.size(); ++p) {
          const int v = levels[l].values[4 * p + std::size_t(channel)];
          INFO(width << "x" << height << " level " << l << " pixel " << p << " channel " << channel);
          // 1e-4: intermediate levels are rounded to 16 bits.
          const double low = colour ? light(v - 0.5) : (v - 0.5) / 255,
                       high = colour ? light(v + 0.5) : (v + 0.5) / 255;
          REQUIRE(exact[p] >= low - 1e-4);
          REQUIRE(exact[p] <= high + 1e-4);
        }
      }
    }
  }
}

TEST_CASE("empty and single-channel images have no mips") {
  CHECK_THROWS_AS(buildMips(Image8()), Error);
  CHECK_THROWS_AS(buildMips(Image8(4, 4, 1)), Error);
}
