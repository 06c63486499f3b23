// SPDX-License-Identifier: Apache-2.0
// Properties of the ECC; ecc_sums_test.cpp tests its exactness.
#include "image/ecc_sums.h"

#include <array>
#include <catch2/catch.hpp>
#include <limits>

#include "ecc_samples.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr EccDefinition kBoth[] = {EccDefinition::channels, EccDefinition::concatenated};

// RGB texture around a colour, with this standard deviation.
Samples texture(std::size_t samples, double deviation, glm::dvec3 colour, std::uint32_t seed) {
  Noise noise(seed);
  Samples values;
  for (std::size_t i = 0; i < samples; ++i)
    for (int c = 0; c < 3; ++c) values.push_back(level(colour[c] + deviation * noise()));
  return values;
}

Ecc bySamples(const Samples& a, const Samples& b, double floor = 0) {
  EccSums sums;
  for (std::size_t i = 0; i < a.size(); i += 3) sums.add({a[i], a[i + 1], a[i + 2]}, {b[i], b[i + 1], b[i + 2]});
  return sums.result(floor);
}

// ECC in two passes of long double, with one mean for each of `channels`, or one mean for all.
double byDefinition(const Samples& a, const Samples& b, std::size_t channels, double floor) {
  const long double n = (long double)(a.size()) / (long double)(channels);
  long double covariance = 0, varianceA = 0, varianceB = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    long double meanA = 0, meanB = 0;
    for (std::size_t i = c; i < a.size(); i += channels) meanA += a[i] / n, meanB += b[i] / n;
    for (std::size_t i = c; i < a.size(); i += channels) {
      covariance += (a[i] - meanA) * (b[i] - meanB);
      varianceA += (a[i] - meanA) * (a[i] - meanA);
      varianceB += (b[i] - meanB) * (b[i] - meanB);
    }
  }
  const long double all = (long double)(a.size()) * floor;
  return double((covariance + all) / std::sqrt((varianceA + all) * (varianceB + all)));
}

}  // namespace

TEST_CASE("ECC equals its definitions, from integer sums and sample by sample", "[N2]") {
  for (double deviation : {1.5, 6.0, 30.0})
    for (double mean : {20.0, 128.0, 230.0})
      for (int floor : {0, 25}) {
        const Samples a = texture(700, deviation, {mean, mean, mean - 10}, 1);
        Samples b = texture(700, deviation, glm::dvec3(mean), 2);
        for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::uint8_t((2 * a[i] + b[i]) / 3);
        const std::vector<EccMoments> sums = preEcc(a, b);
        const double expected = byDefinition(a, b, 3, floor);
        CHECK(ecc(sums, EccDefinition::channels, floor).defined);
        CHECK(ecc(sums, EccDefinition::channels, floor).value == Approx(expected).margin(1e-12).epsilon(0));
        CHECK(bySamples(a, b, floor).value == Approx(expected).margin(1e-12).epsilon(0));
        CHECK(ecc(sums, EccDefinition::concatenated, floor).value ==
              Approx(byDefinition(a, b, 1, 0)).margin(1e-12).epsilon(0));
      }
}

TEST_CASE("ECC is 1 for equal samples, -1 for the negative, and ignores gain and offset", "[N2]") {
  const Samples a = texture(500, 12, {90, 130, 160}, 1);
  Samples negative = a, gained = a;
  for (std::size_t i = 0; i < a.size(); ++i) {
    negative[i] = std::uint8_t(255 - a[i]);
    gained[i] = std::uint8_t(a[i] + 10 + 15 * int(i % 3));  // an offset for each channel
  }
  for (const EccDefinition definition : kBoth) {
    CHECK(ecc(preEcc(a, a), definition).value == 1.0);
    CHECK(ecc(preEcc(a, negative), definition).value == -1.0);
  }
  CHECK(ecc(preEcc(a, gained)).value == 1.0);
  CHECK(ecc(preEcc(a, gained), EccDefinition::concatenated).value < 0.999);
  CHECK(bySamples(a, a).value == 1.0);
  const Samples other = texture(500, 12, {90, 130, 160}, 2);
  EccMoments wide, doubled;
  for (std::size_t i = 0; i < a.size(); ++i) {
    wide.add(a[i], other[i]);
    doubled.add(256 * (a[i] - 128), 512 * (other[i] - 128) + 77);  // 8 fraction bits, relative to mid-grey; gain 2
  }
  CHECK(ecc({&doubled, 1}).value == Approx(ecc({&wide, 1}).value).margin(1e-15).epsilon(0));
  CHECK(ecc(preEcc(a, other)).value == ecc(preEcc(other, a)).value);
}

TEST_CASE("targets count together, each relative to its own means") {
  const Samples a = texture(400, 9, {90, 130, 160}, 1), b = texture(300, 9, {60, 60, 60}, 2);
  Samples brighter = b;
  for (auto& v : brighter) v = std::uint8_t(v + 90);
  std::vector<EccMoments> sums = preEcc(a, a);
  for (const EccMoments& s : preEcc(b, brighter)) sums.push_back(s);
  CHECK(ecc(sums).value == 1.0);
  CHECK(ecc(sums, EccDefinition::concatenated).value < 0.9);
}

TEST_CASE("unrelated textures of one colour correlate by the paper's definition, but not by ours", "[N2]") {
  // Expected values of the paper's definition, for four standard deviations.
  const std::array<double, 4> deviations{2, 10, 20, 40}, paper{0.998, 0.954, 0.836, 0.575};
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const glm::dvec3 colour(90, 130, 200);
    const std::vector<EccMoments> sums =
        preEcc(texture(20000, deviations[k], colour, 1), texture(20000, deviations[k], colour, 2));
    CHECK(ecc(sums, EccDefinition::concatenated).value == Approx(paper[k]).margin(0.01));
    CHECK(std::abs(ecc(sums).value) < 0.02);
  }
}

TEST_CASE("ECC of flat samples is undefined without a floor", "[N2][T5]") {
  const Samples flat = texture(500, 0, {10, 200, 30}, 1), other = texture(500, 0, {90, 90, 90}, 1);
  const Samples rough = texture(500, 9, {128, 128, 128}, 1), grey(50, 128), noisy(rough.begin(), rough.begin() + 50);
  const Samples none, pixel{1, 2, 3};
  std::vector<Ecc> undefined{bySamples(flat, flat), bySamples(flat, rough), EccSums().result(), EccSums().result(25)};
  for (const EccDefinition definition : kBoth) {
    for (int floor : {0, 25}) {
      undefined.push_back(ecc({}, definition, floor));
      undefined.push_back(ecc(preEcc(none, none), definition, floor));
      undefined.push_back(ecc(preEcc(pixel, pixel), definition, floor));
    }
    undefined.push_back(ecc(preEcc(grey, grey, 1), definition));
    undefined.push_back(ecc(preEcc(grey, noisy, 1), definition));
    undefined.push_back(ecc(preEcc(noisy, grey, 1), definition));
  }
  undefined.push_back(ecc(preEcc(grey, noisy, 1), EccDefinition::concatenated, 25));
  for (const Samples* b : {&flat, &other, &rough}) {
    undefined.push_back(ecc(preEcc(flat, *b)));
    undefined.push_back(ecc(preEcc(*b, flat)));
  }
  for (const Ecc& e : undefined) {
    CHECK_FALSE(e.defined);
    CHECK(e.value == 0.0);
  }
  CHECK(ecc(preEcc(flat, other), EccDefinition::channels, 25).value == 1.0);
  CHECK(bySamples(flat, other, 25).value == 1.0);
  // Noise of 3 8-bit levels against a flat picture: 25 / √(25 · 34).
  CHECK(ecc(preEcc(flat, texture(500, 3, {128, 128, 128}, 1)), EccDefinition::channels, 25).value ==
        Approx(std::sqrt(25.0 / 34.0)).margin(0.03));
}

TEST_CASE("ECC never exceeds one", "[N2]") {
  for (std::uint32_t seed = 1; seed <= 3000; ++seed) {
    Samples a = texture(2 + seed % 7, 1 + seed % 50, {30, 40, 50}, seed), b;
    for (auto& v : a) {
      v = std::min<std::uint8_t>(v, 85);
      b.push_back(std::uint8_t(3 * v));
    }
    for (const EccDefinition definition : kBoth) {
      const double value = ecc(preEcc(a, b), definition).value;
      REQUIRE(value <= 1.0);
      REQUIRE(value > 1 - 1e-15);
    }
  }
}

TEST_CASE("rounding of interpolation does not count as texture") {
  EccSums sums;
  for (int i = 0; i < 100; ++i) sums.add(glm::dvec3(100.0 + 1e-5 * (i % 3)), glm::dvec3(40.0 + 1e-5 * (i % 5)));
  CHECK_FALSE(sums.result().defined);
}

TEST_CASE("values that are not finite leave ECC undefined", "[N2][N16]") {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 1e100}) {
    EccSums sums;
    for (int i = 0; i < 10; ++i) sums.add(glm::dvec3(i), glm::dvec3(3 - i));
    sums.add(glm::dvec3(bad), glm::dvec3(-bad));
    CHECK_FALSE(sums.result(25).defined);
  }
}
