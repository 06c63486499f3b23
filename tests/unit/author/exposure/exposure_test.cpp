// SPDX-License-Identifier: Apache-2.0
#include "author/exposure/exposure.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <limits>
#include <random>

using namespace ibr;

namespace {

using Gains = std::vector<glm::dvec3>;

Gains gainsOf(std::size_t photographs, const std::vector<ExposureMatch>& matches,
              const std::vector<CaptureMetadata>& exif = {}) {
  return solveExposures(photographs, matches, exif).gains;
}

// Random gains between 1/span and span, with a mean log of 0.
Gains planted(std::size_t photographs, double span, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  Gains gains;
  glm::dvec3 sum(0.0);
  for (std::size_t n = 0; n < photographs; ++n) {
    gains.push_back(std::log(span) * glm::dvec3(unit(random), unit(random), unit(random)));
    sum += gains.back();
  }
  for (glm::dvec3& g : gains) g = glm::exp(g - sum / double(photographs));
  return gains;
}

// `each` points in each pair of neighbours in a ring; a share of the points is wrong, all in one direction.
std::vector<ExposureMatch> ring(const Gains& gains, std::size_t each, double wrong, std::uint64_t seed = 2) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<ExposureMatch> matches;
  for (std::uint32_t a = 0; a < gains.size(); ++a) {
    const std::uint32_t b = (a + 1) % std::uint32_t(gains.size());
    if (a == b || (gains.size() == 2 && a == 1)) continue;
    for (std::size_t k = 0; k < each; ++k) {
      glm::dvec3 ratio = glm::log(gains[b] / gains[a]);
      if (unit(random) < wrong) ratio += glm::dvec3(0.2 + 2 * unit(random), 0.5 * unit(random), 1 + unit(random));
      matches.push_back({a, b, ratio, 0.02 + 0.1 * unit(random)});
    }
  }
  return matches;
}

double worst(const Gains& a, const Gains& b) {
  double most = 0;
  for (std::size_t n = 0; n < a.size(); ++n)
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[n][c] / b[n][c] - 1));
  return most;
}

}  // namespace

TEST_CASE("planted gains are recovered") {
  for (const double span : {1.0, 1.1, 2.0, 16.0})
    for (const std::size_t photographs : {2, 3, 40}) {
      const Gains gains = planted(photographs, span);
      INFO(span << ", " << photographs);
      CHECK(worst(gainsOf(photographs, ring(gains, 30, 0)), gains) < 1e-6);
    }
}

TEST_CASE("planted gains are recovered with three tenths of the matches wrong, all to one side") {
  for (const double span : {1.2, 4.0, 16.0})
    for (const std::size_t photographs : {2, 12}) {
      const Gains gains = planted(photographs, span);
      INFO(span << ", " << photographs);
      CHECK(worst(gainsOf(photographs, ring(gains, 200, 0.3)), gains) < 1e-4);
    }
}

TEST_CASE("noise averages out") {
  const Gains gains = planted(10, 2);
  std::vector<ExposureMatch> matches = ring(gains, 500, 0.2);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (ExposureMatch& m : matches) m.ratio += m.deviation * glm::dvec3(normal(random), normal(random), normal(random));
  CHECK(worst(gainsOf(10, matches), gains) < 0.02);
}

TEST_CASE("the order of photographs and matches does not change gains") {
  const Gains gains = planted(8, 3);
  const std::vector<ExposureMatch> matches = ring(gains, 50, 0.2);
  const Gains first = gainsOf(8, matches);
  std::vector<ExposureMatch> turned(matches.rbegin(), matches.rend());
  for (ExposureMatch& m : turned) m = {7 - m.second, 7 - m.first, -m.ratio, m.deviation};
  Gains second = gainsOf(8, turned);
  std::ranges::reverse(second);
  CHECK(worst(first, second) < 1e-9);
}

TEST_CASE("parts that no match joins keep their own mean, and photographs without matches are unchanged") {
  const Gains left = planted(4, 2, 1), right = planted(3, 8, 7);
  std::vector<ExposureMatch> matches = ring(left, 20, 0);
  for (ExposureMatch m : ring(right, 20, 0)) {
    m.first += 4;
    m.second += 4;
    matches.push_back(m);
  }
  matches.push_back({0, 7, glm::dvec3(2.0), 0.01});  // a single match is ignored
  const Gains gains = gainsOf(8, matches);
  CHECK(worst(Gains(gains.begin(), gains.begin() + 4), left) < 1e-6);
  CHECK(worst(Gains(gains.begin() + 4, gains.begin() + 7), right) < 1e-6);
  CHECK(gains[7] == glm::dvec3(1.0));
  CHECK(gainsOf(2, {}) == Gains(2, glm::dvec3(1.0)));
  CHECK(gainsOf(0, {}).empty());
}

TEST_CASE("EXIF gives the exposure of a photograph without matches, and yields to matches") {
  const auto exposed = [](double time) {
    return CaptureMetadata{.exposureTime = time, .fNumber = 4, .iso = 100, .model = "M1"};
  };
  Gains gains(3, glm::dvec3(1.0));
  gains[0] *= 2;
  gains[1] /= 2;
  std::vector<ExposureMatch> matches = ring({gains[0], gains[1]}, 50, 0);
  // EXIF: photographs 1 and 2 receive four times the light of photograph 0. Matches know the gains of 0 and 1 only.
  const std::vector<CaptureMetadata> exif{exposed(0.01), exposed(0.04), exposed(0.04)};
  CHECK(worst(gainsOf(3, matches, exif), {gains[0], gains[1], gains[1]}) < 1e-6);
  // Matches with many points outweigh EXIF.
  const std::vector<CaptureMetadata> wrong{exposed(0.04), exposed(0.01), {}};
  CHECK(worst(gainsOf(3, matches, wrong), {gains[0], gains[1], glm::dvec3(1.0)}) < 0.01);
  // EXIF of another camera cannot be compared with the first two photographs.
  std::vector<CaptureMetadata> other = exif;
  other[2].model = "M2";
  CHECK(gainsOf(3, matches, other)[2] == glm::dvec3(1.0));
}

TEST_CASE("gains stay within the limits of a scene") {
  const Gains gains = gainsOf(2, std::vector<ExposureMatch>(20, {0, 1, glm::dvec3(40.0), 0.1}));
  CHECK(gains[0].r == Approx(1 / kMaxGain));
  CHECK(gains[1].r == Approx(kMaxGain));
}

TEST_CASE("invisible gains are dropped") {
  Gains gains = planted(5, 1.009);
  Exposures exposures = solveExposures(5, ring(gains, 30, 0));
  CHECK(exposures.alike);
  CHECK(exposures.gains == Gains(5, glm::dvec3(1)));
  CHECK(exposures.measured == 5);
  CHECK(describeExposures(exposures).find("alike") != std::string::npos);
  for (glm::dvec3& gain : gains) gain.b = 1;
  gains[2].b = 1.03;
  exposures = solveExposures(5, ring(gains, 30, 0));  // one channel of one match suffices
  CHECK(!exposures.alike);
  CHECK(exposures.gains[2].b > 1.02);
}

TEST_CASE("gains of eight stops are recovered") {
  const Gains gains = planted(6, 16);
  CHECK(worst(gainsOf(6, ring(gains, 100, 0.2)), gains) < 1e-4);
}

TEST_CASE("non-finite matches and EXIF data are ignored") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const Gains gains = planted(4, 2);
  std::vector<ExposureMatch> matches = ring(gains, 40, 0);
  for (const double bad : {nan, infinity, -infinity}) {
    matches.push_back({0, 1, glm::dvec3(0, bad, 0), 0.1});
    matches.push_back({1, 2, glm::dvec3(0.0), bad});
  }
  matches.push_back({1, 2, glm::dvec3(0.0), 0});
  matches.push_back({1, 2, glm::dvec3(0.0), -1});
  std::vector<CaptureMetadata> exif(4);
  exif[0] = {.exposureTime = nan, .fNumber = 4, .iso = 100};
  exif[1] = {.exposureTime = 0.01, .fNumber = 0, .iso = 100};
  exif[2] = {.exposureTime = infinity, .fNumber = 4, .iso = 100};
  exif[3] = {.exposureTime = 0.01, .fNumber = 4, .iso = -100};
  CHECK(worst(gainsOf(4, matches, exif), gains) < 1e-6);
  CHECK(gainsOf(4, {}, exif) == Gains(4, glm::dvec3(1)));
}
