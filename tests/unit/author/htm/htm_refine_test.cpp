// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_refine.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "htm_object.h"

namespace ibr {
namespace {

// Displaced waves that differ by channel; callers may change brightness and contrast.
double waveAt(glm::dvec2 at, std::size_t colour) {
  const double c = double(colour);
  return 120 + 50 * std::sin(0.31 * at.x + 0.12 * at.y + c) + 40 * std::cos(0.07 * at.x - 0.27 * at.y + 2 * c);
}
Image8 waves(int width, int height, glm::dvec2 by) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        picture.pixel(x, y)[c] = std::uint8_t(std::lround(waveAt(glm::dvec2(x, y) - by, c)));
  return picture;
}

// Samples a disc of the undisplaced waves; `lighter` in 8-bit levels is added.
std::vector<TemplateSample> disc(glm::ivec2 middle, int radius, int lighter = 0) {
  std::vector<TemplateSample> samples;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      if (x * x + y * y > radius * radius || (x == 1 && y % 3 == 0)) continue;  // the disc has holes
      const auto level = [&](std::size_t c) {
        return std::uint8_t(std::lround(waveAt(glm::dvec2(middle + glm::ivec2(x, y)), c)) + lighter);
      };
      samples.push_back({std::int16_t(middle.x + x), std::int16_t(middle.y + y), level(0), level(1), level(2)});
    }
  return samples;
}

}  // namespace

TEST_CASE("a match is refined to a fraction of a pixel, whatever the brightness", "[N12]") {
  const glm::dvec2 by(3.37, -2.61);
  const Image8 picture = waves(90, 70, by);
  const VertexMatch plain = refinedMatch(picture, disc({40, 35}, 9), {3, -3}, 2);
  CHECK(glm::distance(glm::dvec2(plain.displacement), by) < 0.03);
  CHECK(plain.information.x > 0);
  CHECK(plain.information.x * plain.information.z > plain.information.y * plain.information.y);
  const VertexMatch lit = refinedMatch(picture, disc({40, 35}, 9, 20), {3, -3}, 2);
  CHECK(glm::distance(lit.displacement, plain.displacement) < 1e-3f);
  // At the exact start the result stays. The order of samples has no effect.
  std::vector<TemplateSample> samples = disc({40, 35}, 9);
  std::ranges::reverse(samples);
  CHECK(glm::distance(refinedMatch(picture, samples, by, 2).displacement, plain.displacement) < 0.02f);
}

TEST_CASE("templates at the image border are matched", "[N12]") {
  const glm::dvec2 by(-0.4, 0.3);
  const Image8 picture = waves(60, 50, by);
  for (const glm::ivec2 middle : {glm::ivec2(2, 25), {57, 25}, {30, 1}, {30, 48}, {0, 0}}) {
    std::vector<TemplateSample> inside = disc(middle, 8);
    std::erase_if(inside, [](const TemplateSample& s) { return s.x < 1 || s.y < 1 || s.x > 58 || s.y > 48; });
    CHECK(glm::distance(glm::dvec2(refinedMatch(picture, inside, {0, 0}, 2).displacement), by) < 0.1);
  }
  // Far outside the picture there is no gradient, so the result has no information.
  const VertexMatch outside = refinedMatch(picture, disc({30, 25}, 6), {5000, -5000}, 2);
  CHECK(outside.information == glm::vec3(0));
  CHECK(outside.displacement == glm::vec2(0));
}

TEST_CASE("without texture there is no displacement", "[N12][T24]") {
  CHECK(refinedMatch(test::plain(pinholeFromFov(60, 50, 1)), disc({30, 25}, 6), {2, 1}, 2).information == glm::vec3(0));
  CHECK(refinedMatch(waves(60, 50, {}), {}, {1, 1}, 2).information == glm::vec3(0));
  // Vertical stripes give no information along the stripes.
  Image8 stripes(60, 50, 3);
  std::vector<TemplateSample> samples;
  const auto level = [](double x) { return std::uint8_t(std::lround(128 + 90 * std::sin(0.5 * x))); };
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x) {
      std::ranges::fill(stripes.pixel(x, y), level(x - 1.4));
      if (std::abs(x - 30) < 8 && std::abs(y - 25) < 8)
        samples.push_back({std::int16_t(x), std::int16_t(y), level(x), level(x), level(x)});
    }
  const VertexMatch match = refinedMatch(stripes, samples, {1, 2}, 2);
  CHECK(match.displacement.x == Approx(1.4).margin(0.03));
  CHECK(std::abs(match.displacement.y) < 1e-3f);
  CHECK(match.information.x > 1);
  CHECK(match.information.z < 1e-3f * match.information.x);
}

}  // namespace ibr
