// SPDX-License-Identifier: Apache-2.0
#include "ibr/template_search.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "support/error_of.h"

namespace ibr {
namespace {

using enum TemplateMeasure;
using Colour = std::array<int, 3>;

template <class F>
Image8 pictureOf(int width, int height, F&& colourAt) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Colour colour = colourAt(x, y);
      for (std::size_t c = 0; c < 3; ++c) picture.pixel(x, y)[c] = std::uint8_t(colour[c]);
    }
  return picture;
}

Image8 noise(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  return pictureOf(width, height, [&](int, int) {
    return Colour{int(random() % 200) + 20, int(random() % 200) + 20, int(random() % 200) + 20};
  });
}

Colour clampedAt(const Image8& picture, int x, int y) {
  const auto p = picture.pixel(std::clamp(x, 0, picture.width - 1), std::clamp(y, 0, picture.height - 1));
  return {p[0], p[1], p[2]};
}

// Square of samples with the picture's colours at an offset of `shift`, each colour · gain + offset.
std::vector<TemplateSample> square(const Image8& picture, glm::ivec2 corner, int side, glm::ivec2 shift,
                                   double gain = 1, double offset = 0) {
  std::vector<TemplateSample> samples;
  const auto lit = [&](int value) { return std::uint8_t(std::clamp(gain * value + offset + 0.5, 0.0, 255.0)); };
  for (int y = corner.y; y < corner.y + side; ++y)
    for (int x = corner.x; x < corner.x + side; ++x) {
      const Colour c = clampedAt(picture, x + shift.x, y + shift.y);
      samples.push_back({std::int16_t(x), std::int16_t(y), lit(c[0]), lit(c[1]), lit(c[2])});
    }
  return samples;
}

TemplateMatch searched(const Image8& picture, const std::vector<TemplateSample>& samples, glm::ivec2 start, int radius,
                       TemplateMeasure measure) {
  const Image8* pictures[] = {&picture};
  const TemplateTask task{0, 0, std::uint32_t(samples.size()), start};
  const auto matches = cpuTemplateSearch(pictures)({&task, 1}, samples, radius, measure);
  REQUIRE(matches.size() == 1);
  CHECK(std::isfinite(matches[0].cost) != samples.empty());
  return matches[0];
}

double costAt(const Image8& picture, const std::vector<TemplateSample>& samples, glm::ivec2 at,
              TemplateMeasure measure) {
  const double n = double(samples.size());
  Colour none{};
  std::array<double, 3> meanA{}, meanB{};
  const auto pair = [&](const TemplateSample& s) {
    return std::pair(Colour{s.red, s.green, s.blue}, clampedAt(picture, s.x + at.x, s.y + at.y));
  };
  double apart = 0;
  for (const TemplateSample& s : samples) {
    const auto [a, b] = pair(s);
    for (std::size_t c = 0; c < none.size(); ++c)
      meanA[c] += a[c] / n, meanB[c] += b[c] / n, apart += std::abs(a[c] - b[c]);
  }
  if (measure == absoluteDifferences) return apart / (3 * n);
  double aa = 0, bb = 0, ab = 0;
  for (const TemplateSample& s : samples) {
    const auto [a, b] = pair(s);
    for (std::size_t c = 0; c < none.size(); ++c) {
      const double da = a[c] - meanA[c], db = b[c] - meanB[c];
      aa += da * da, bb += db * db, ab += da * db;
    }
  }
  return aa > 1e-6 && bb > 1e-6 ? 1 - ab / std::sqrt(aa * bb) : 1;
}

}  // namespace

TEST_CASE("every displacement is tried, and the cost follows the measure") {
  const Image8 picture = noise(31, 23, 1), other = noise(9, 9, 2);
  for (const TemplateMeasure measure : {absoluteDifferences, correlation})
    for (const glm::ivec2 corner : {glm::ivec2(10, 8), {-3, -4}, {27, 19}, {-30, 40}})
      for (const glm::ivec2 start : {glm::ivec2(0), {3, -2}, {-40, 2}}) {
        INFO(int(measure) << " " << corner.x << " " << start.x);
        const std::vector<TemplateSample> samples = square(other, {0, 0}, 5, {1, 1});
        std::vector<TemplateSample> moved = samples;
        for (TemplateSample& s : moved) s.x = std::int16_t(s.x + corner.x), s.y = std::int16_t(s.y + corner.y);
        const TemplateMatch match = searched(picture, moved, start, 4, measure);
        double least = std::numeric_limits<double>::infinity();
        for (int dy = -4; dy <= 4; ++dy)
          for (int dx = -4; dx <= 4; ++dx)
            least = std::min(least, costAt(picture, moved, start + glm::ivec2(dx, dy), measure));
        CHECK(match.cost == Approx(least).margin(1e-5));
        CHECK(costAt(picture, moved, match.displacement, measure) == Approx(least).margin(1e-5));
        CHECK(std::abs(match.displacement.x - start.x) <= 4);
        CHECK(std::abs(match.displacement.y - start.y) <= 4);
      }
}

TEST_CASE("a planted displacement is found up to the border of the window", "[N12]") {
  const Image8 picture = noise(60, 50, 3);
  for (const TemplateMeasure measure : {absoluteDifferences, correlation})
    for (const glm::ivec2 shift : {glm::ivec2(0), {6, -6}, {-6, 6}, {5, 3}}) {
      const auto samples = square(picture, {20, 20}, 7, shift);
      const TemplateMatch match = searched(picture, samples, {0, 0}, 6, measure);
      CHECK(match.displacement == shift);
      CHECK(match.cost == Approx(0).margin(1e-6));
      CHECK(searched(picture, samples, {9, 1}, 3, measure).cost >
            (shift == glm::ivec2(6, -6) || shift == glm::ivec2(5, 3) ? -1 : 0.01));
      CHECK(searched(picture, samples, shift, 0, measure).displacement == shift);
    }
}

TEST_CASE("flat images match at the start", "[N12][T24]") {
  const Image8 flat = pictureOf(40, 40, [](int, int) { return Colour{90, 120, 30}; });
  for (const glm::ivec2 start : {glm::ivec2(0), {5, -3}, {-100, 100}}) {
    const auto same = square(flat, {15, 15}, 6, {0, 0});
    CHECK(searched(flat, same, start, 8, absoluteDifferences).displacement == start);
    CHECK(searched(flat, same, start, 8, absoluteDifferences).cost == 0);
    // OpenCV's correlation of a flat template is 1, the maximum; this search treats the template as uninformative.
    CHECK(searched(flat, same, start, 8, correlation).displacement == start);
    CHECK(searched(flat, same, start, 8, correlation).cost == 1);
    CHECK(searched(flat, square(noise(40, 40, 4), {15, 15}, 6, {0, 0}), start, 8, correlation).displacement == start);
    CHECK(searched(noise(40, 40, 4), same, start, 8, correlation).cost == 1);
  }
}

TEST_CASE("a repeating pattern is matched nearest to the start, then first by rows", "[N12]") {
  const Image8 checks = pictureOf(64, 64, [](int x, int y) {
    const int phase = (x % 8) * 8 + y % 8;
    return Colour{phase * 3, (phase * 37) % 251, (phase * 91) % 241};
  });
  for (const TemplateMeasure measure : {absoluteDifferences, correlation}) {
    const auto samples = square(checks, {28, 28}, 9, {0, 0});
    CHECK(searched(checks, samples, {0, 0}, 12, measure).displacement == glm::ivec2(0));
    CHECK(searched(checks, samples, {3, -3}, 12, measure).displacement == glm::ivec2(0));
    CHECK(searched(checks, samples, {5, 3}, 12, measure).displacement == glm::ivec2(8, 0));
    CHECK(searched(checks, samples, {4, 4}, 12, measure).displacement == glm::ivec2(0));
    CHECK(searched(checks, samples, {4, -1}, 12, measure).displacement == glm::ivec2(0));
  }
  const Image8 stripes = pictureOf(40, 40, [](int x, int) { return Colour{x % 2 * 100, 50, 50}; });
  const auto shifted = square(stripes, {15, 15}, 6, {1, 0});
  CHECK(searched(stripes, shifted, {0, 0}, 5, absoluteDifferences).displacement == glm::ivec2(-1, 0));
}

TEST_CASE("correlation ignores gain and offset of brightness", "[N12]") {
  const Image8 picture = noise(60, 60, 5);
  for (const auto& [gain, offset] : {std::pair(1.0, 30.0), {0.5, 0.0}, {0.4, 120.0}, {1.1, -15.0}}) {
    INFO(gain << " " << offset);
    const auto samples = square(picture, {25, 25}, 9, {4, -3}, gain, offset);
    const TemplateMatch match = searched(picture, samples, {0, 0}, 8, correlation);
    CHECK(match.displacement == glm::ivec2(4, -3));
    CHECK(match.cost >= 0);
    CHECK(match.cost < 0.01);
    const TemplateMatch differences = searched(picture, samples, {0, 0}, 8, absoluteDifferences);
    CHECK(differences.cost <= costAt(picture, samples, {4, -3}, absoluteDifferences) + 1e-4);
  }
  // The negative has the lowest possible correlation.
  const auto negative = square(picture, {25, 25}, 9, {0, 0}, -1, 255);
  CHECK(searched(picture, negative, {0, 0}, 0, correlation).cost == Approx(2));
}

TEST_CASE("results have the order of the tasks, also of tasks without samples", "[N12]") {
  const Image8 a = noise(50, 40, 6), b = noise(30, 60, 7);
  const Image8* pictures[] = {&a, &b};
  const auto search = cpuTemplateSearch(pictures);
  std::vector<TemplateSample> samples = square(a, {20, 20}, 6, {2, 1});
  const auto second = square(b, {10, 30}, 6, {-3, 4});
  samples.insert(samples.end(), second.begin(), second.end());
  const std::vector<TemplateTask> tasks{
      {1, 36, 36, {0, 0}}, {0, 72, 0, {7, -7}}, {0, 0, 36, {0, 0}}, {1, 5, 0, {0, 0}}};
  for (const TemplateMeasure measure : {absoluteDifferences, correlation}) {
    const auto matches = search(tasks, samples, 5, measure);
    REQUIRE(matches.size() == 4);
    CHECK(matches[0].displacement == glm::ivec2(-3, 4));
    CHECK(matches[1].displacement == glm::ivec2(7, -7));
    CHECK(std::isinf(matches[1].cost));
    CHECK(matches[2].displacement == glm::ivec2(2, 1));
    CHECK(std::isinf(matches[3].cost));
    CHECK(search({}, {}, 5, measure).empty());
  }
}

TEST_CASE("the largest template does not overflow", "[N12]") {
  const Image8 black = pictureOf(80, 80, [](int, int) { return Colour{0, 0, 0}; });
  const Image8 white = pictureOf(80, 80, [](int, int) { return Colour{255, 255, 255}; });
  const auto samples = square(white, {8, 8}, 64, {0, 0});
  REQUIRE(samples.size() == kMaxTemplateSampleCount);
  CHECK(searched(black, samples, {0, 0}, 1, absoluteDifferences).cost == 255);
  CHECK(searched(white, samples, {0, 0}, kMaxTemplateRadius, correlation).cost == 1);
  const Image8 halves = pictureOf(80, 80, [](int x, int) { return x < 40 ? Colour{255, 255, 255} : Colour{0, 0, 0}; });
  CHECK(searched(halves, square(halves, {8, 8}, 64, {0, 0}), {0, 0}, 2, correlation).cost == Approx(0).margin(1e-6));
}

TEST_CASE("invalid images, radii and tasks are refused") {
  const Image8 picture = noise(20, 20, 8), grey(20, 20, 1), none;
  const Image8* pictures[] = {&picture};
  for (const Image8* wrong : {&grey, &none}) {
    const Image8* both[] = {&picture, wrong};
    CHECK(test::errorOf([&] { cpuTemplateSearch(both); }).code() == ErrorCode::invalidInput);
  }
  const auto search = cpuTemplateSearch(pictures);
  const auto samples = square(picture, {0, 0}, 10, {0, 0});
  const auto fails = [&](const TemplateTask& task, int radius) {
    CHECK(test::errorOf([&] {
            search({&task, 1}, samples, radius, absoluteDifferences);
          }).code() == ErrorCode::invalidInput);
  };
  fails({0, 0, 10, {0, 0}}, -1);
  fails({0, 0, 10, {0, 0}}, kMaxTemplateRadius + 1);
  fails({1, 0, 10, {0, 0}}, 2);
  fails({0, 1, 100, {0, 0}}, 2);
  fails({0, 101, 0, {0, 0}}, 2);
  fails({0, ~0u, ~0u, {0, 0}}, 2);
  const std::vector<TemplateSample> many(kMaxTemplateSampleCount + 1);
  const TemplateTask task{0, 0, kMaxTemplateSampleCount + 1, {0, 0}};
  CHECK(test::errorOf([&] { search({&task, 1}, many, 2, correlation); }).code() == ErrorCode::invalidInput);
}

}  // namespace ibr
