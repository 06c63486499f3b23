// SPDX-License-Identifier: Apache-2.0
#include "image/ecc.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "ibr/error.h"

using namespace ibr;

namespace {

using Samples = std::vector<std::uint8_t>;

// Texture of the given deviation around a colour; kept within range by the colours chosen.
Samples texture(std::size_t samples, double deviation, glm::dvec3 colour, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  Samples values;
  for (std::size_t i = 0; i < samples; ++i)
    for (int c = 0; c < 3; ++c)
      values.push_back(std::uint8_t(std::clamp(std::lround(colour[c] + normal(random)), 0L, 255L)));
  return values;
}

Ecc bySamples(const Samples& a, const Samples& b, double floor = 0) {
  EccSums sums;
  for (std::size_t i = 0; i < a.size(); i += 3) sums.add({a[i], a[i + 1], a[i + 2]}, {b[i], b[i + 1], b[i + 2]});
  return sums.result(floor);
}

// The definition, two passes in long double.
double byDefinition(const Samples& a, const Samples& b, double floor) {
  const std::size_t n = a.size() / 3;
  long double covariance = 0, varianceA = 0, varianceB = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    long double meanA = 0, meanB = 0;
    for (std::size_t i = c; i < a.size(); i += 3) meanA += a[i], meanB += b[i];
    meanA /= (long double)n;
    meanB /= (long double)n;
    for (std::size_t i = c; i < a.size(); i += 3) {
      covariance += (a[i] - meanA) * (b[i] - meanB);
      varianceA += (a[i] - meanA) * (a[i] - meanA);
      varianceB += (b[i] - meanB) * (b[i] - meanB);
    }
  }
  const long double all = 3.0L * (long double)n;
  return double((covariance / all + floor) / std::sqrt((varianceA / all + floor) * (varianceB / all + floor)));
}

}  // namespace

TEST_CASE("ECC equals its definition, exactly summed and sample by sample") {
  for (double deviation : {1.5, 6.0, 30.0})
    for (double mean : {20.0, 128.0, 230.0})
      for (double floor : {0.0, 25.0}) {
        const Samples a = texture(700, deviation, glm::dvec3(mean), 1);
        Samples b = texture(700, deviation, glm::dvec3(mean), 2);
        for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::uint8_t((2 * a[i] + b[i]) / 3);
        const double expected = byDefinition(a, b, floor);
        CHECK(ecc(a, b, floor).defined);
        CHECK(ecc(a, b, floor).value == Approx(expected).margin(1e-12).epsilon(0));
        CHECK(bySamples(a, b, floor).value == Approx(expected).margin(1e-12).epsilon(0));
      }
}

TEST_CASE("ECC of one, of the negative, and of gain and offset") {
  const Samples a = texture(500, 12, {90, 130, 160}, 1);
  Samples negative = a, gained = a;
  for (std::size_t i = 0; i < a.size(); ++i) {
    negative[i] = std::uint8_t(255 - a[i]);
    gained[i] = std::uint8_t(20 + a[i] / 2 * 2 - a[i] / 2);  // half the contrast, brighter
  }
  CHECK(ecc(a, a).value == 1.0);
  CHECK(ecc(a, negative).value == -1.0);
  CHECK(ecc(a, gained).value > 0.998);
  CHECK(bySamples(a, a).value == 1.0);
  CHECK(ecc(a, texture(500, 12, {90, 130, 160}, 2)).value == Approx(ecc(texture(500, 12, {90, 130, 160}, 2), a).value));
}

TEST_CASE("unrelated textures of one colour do not correlate") {
  // NUMERICS §1 (c): the concatenated form gives 0.998, 0.954, 0.836, 0.575.
  for (double deviation : {2.0, 10.0, 20.0, 40.0}) {
    const glm::dvec3 colour(90, 130, 170);
    CHECK(std::abs(ecc(texture(4000, deviation, colour, 1), texture(4000, deviation, colour, 2)).value) < 0.04);
  }
}

TEST_CASE("nothing to correlate is undefined without a floor") {
  const Samples flat = texture(50, 0, {10, 200, 30}, 1), other = texture(50, 0, {90, 90, 90}, 1);
  const Samples rough = texture(50, 9, {128, 128, 128}, 1);
  for (const Ecc& e : {ecc(flat, flat), ecc(flat, other), ecc(flat, rough), ecc(rough, flat), bySamples(flat, flat),
                       bySamples(flat, rough), ecc(Samples{}, Samples{}), ecc(Samples{1, 2, 3}, Samples{1, 2, 3}, 25),
                       EccSums().result(), EccSums().result(25)}) {
    CHECK_FALSE(e.defined);
    CHECK(e.value == 0.0);
  }
  CHECK(ecc(flat, other, 25).value == 1.0);
  CHECK(bySamples(flat, other, 25).value == 1.0);
  // Noise of 3 grey levels against flat ground: 25 / √(25 · 34).
  CHECK(ecc(flat, texture(50, 3, {128, 128, 128}, 1), 25).value == Approx(std::sqrt(25.0 / 34.0)).margin(0.03));
}

TEST_CASE("interpolation's rounding is no texture") {
  EccSums sums;
  for (int i = 0; i < 100; ++i) sums.add(glm::dvec3(100.0 + 1e-5 * (i % 3)), glm::dvec3(40.0 + 1e-5 * (i % 5)));
  CHECK_FALSE(sums.result().defined);
}

TEST_CASE("exact for a million saturated samples, where naive 32-bit and float sums fail") {
  Samples a(3'000'000, 255), b(3'000'000, 255);
  for (std::size_t i = 0; i < a.size(); i += 6) a[i] = a[i + 1] = a[i + 2] = b[i] = b[i + 1] = b[i + 2] = 254;
  CHECK(ecc(a, b).value == 1.0);
  CHECK(bySamples(a, b).value == Approx(1.0));
}

TEST_CASE("values that are not finite never become a coefficient") {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    EccSums sums;
    for (int i = 0; i < 10; ++i) sums.add(glm::dvec3(i), glm::dvec3(3 - i));
    sums.add(glm::dvec3(bad), glm::dvec3(1));
    CHECK_FALSE(sums.result(25).defined);
  }
}

TEST_CASE("lists that do not match are refused") {
  CHECK_THROWS_AS(ecc(Samples(6), Samples(3)), Error);
  CHECK_THROWS_AS(ecc(Samples(4), Samples(4)), Error);
}
