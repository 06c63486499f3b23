// SPDX-License-Identifier: Apache-2.0
// [H] eq. 5 against a long double evaluation of the formula.
#include "htm/weights.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace ibr {
namespace {

glm::dvec3 atAngle(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::sin(angle), 0, -std::cos(angle)};
}

std::vector<double> logWeights(std::span<const glm::dvec3> directions, glm::dvec3 viewDirection, double gamma) {
  std::vector<double> logs(directions.size());
  htmLogWeights(directions, viewDirection, gamma, logs);
  return logs;
}

// Normalises the weights of the whole set.
std::vector<double> normalised(const std::vector<double>& logs) {
  double sum = 0;
  std::vector<double> weights;
  for (const double log : logs) sum += weights.emplace_back(std::exp(log));
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Exact logarithm: γ₂ · ln((1 + cos θ) / 2) = 2 γ₂ · ln cos(θ / 2).
long double oracle(double degrees, double gamma) {
  const long double half = static_cast<long double>(degrees) * std::numbers::pi_v<long double> / 360;
  return 2 * static_cast<long double>(gamma) * std::log(std::abs(std::cos(half)));
}

}  // namespace

TEST_CASE("weights follow eq. 5 over all angles and exponents", "[htm][N11][T22]") {
  for (const double gamma : {1.0, 2.0, 10.0, 50.0, 200.0, 1000.0}) {
    std::vector<glm::dvec3> directions;
    for (int degrees = 0; degrees <= 180; ++degrees) directions.push_back(3.7 * atAngle(degrees));
    const std::vector<double> logs = logWeights(directions, {0, 0, -0.1}, gamma);
    REQUIRE(logs[0] == 0);
    for (int degrees = 0; degrees <= 180; ++degrees) {
      INFO("gamma " << gamma << ", " << degrees << " degrees");
      const double log = logs[std::size_t(degrees)];
      REQUIRE(std::isfinite(log));
      if (degrees > 0) REQUIRE(log < logs[std::size_t(degrees) - 1]);
      // A relative error of the weight equals an absolute error of its logarithm.
      if (degrees < 180) REQUIRE(std::abs(static_cast<long double>(log) - oracle(degrees, gamma)) < 1e-5L);
    }
    const std::vector<double> weights = normalised(logs);
    double sum = 0;
    for (const double weight : weights) sum += weight;
    CHECK(sum == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("weights of any number of cameras are finite and sum to one", "[htm][N11]") {
  for (std::size_t count = 1; count <= 64; ++count)
    for (const double gamma : {1.0, 50.0, 1000.0}) {
      std::vector<glm::dvec3> directions;
      for (std::size_t i = 0; i < count; ++i) directions.push_back(atAngle(double(i * 37 % 181)));
      const std::vector<double> logs = logWeights(directions, atAngle(200), gamma);
      CHECK(*std::ranges::max_element(logs) == 0);
      double sum = 0;
      for (const double weight : normalised(logs)) {
        REQUIRE(std::isfinite(weight));
        REQUIRE(weight >= 0);
        sum += weight;
      }
      CHECK(sum == Approx(1).epsilon(1e-12));
    }
}

TEST_CASE("opposite cameras weigh the same, and so do cameras of equal direction", "[htm][N11][T22]") {
  const std::vector<glm::dvec3> behind(5, atAngle(180));
  for (const double log : logWeights(behind, atAngle(0), 1000)) CHECK(log == 0);
  const std::vector<glm::dvec3> opposite(3, glm::dvec3(0, 0, 1));
  for (const double log : logWeights(opposite, {0, 0, -1}, 50)) CHECK(log == 0);
  const std::vector<glm::dvec3> two{atAngle(30), atAngle(30), atAngle(90)};
  const std::vector<double> logs = logWeights(two, atAngle(0), 50);
  CHECK(logs[0] == 0);
  CHECK(logs[1] == 0);
  CHECK(logs[2] < -20);
}

TEST_CASE("weights keep small differences of nearly equal directions", "[htm][N11]") {
  const double tiny = 1e-7;  // radians; 1 − cos is 5e-15
  const std::vector<glm::dvec3> directions{{0, 0, -1}, {std::sin(tiny), 0, -std::cos(tiny)}};
  const std::vector<double> logs = logWeights(directions, {0, 0, -1}, 1000);
  CHECK(logs[1] == Approx(-1000 * tiny * tiny / 4).epsilon(1e-5));
}

}  // namespace ibr
