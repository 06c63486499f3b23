// SPDX-License-Identifier: Apache-2.0
#include "htm/weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ibr {
namespace {

// Scales by a power of two first, so that no square overflows or underflows.
glm::dvec3 unit(glm::dvec3 d) {
  int exponent = 0;
  std::frexp(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), &exponent);
  return glm::normalize(glm::dvec3(std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)));
}

}  // namespace

std::vector<double> htmLogWeights(std::span<const glm::dvec3> directions, glm::dvec3 viewDirection, double gamma) {
  constexpr double kLeast = 1e-30;
  const glm::dvec3 a = unit(viewDirection);
  std::vector<double> logs;
  logs.reserve(directions.size());
  for (const glm::dvec3& direction : directions) {
    const glm::dvec3 b = unit(direction);
    const double plus = glm::dot(a + b, a + b), minus = glm::dot(a - b, a - b);
    const double sine = minus / (plus + minus), cosine = plus / (plus + minus);  // sin² and cos² of the half angle
    logs.push_back(gamma * (sine < 0.5 ? std::log1p(-sine) : std::log(std::max(cosine, kLeast))));
  }
  if (logs.empty()) return logs;
  const double largest = *std::ranges::max_element(logs);
  for (double& log : logs) log -= largest;
  return logs;
}

}  // namespace ibr
