// SPDX-License-Identifier: Apache-2.0
#include "htm/weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace ibr {
namespace {

// Scales by a power of two first, so that no square overflows or underflows.
glm::dvec3 unit(glm::dvec3 d) {
  int exponent = 0;
  std::frexp(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), &exponent);
  return glm::normalize(glm::dvec3(std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)));
}

}  // namespace

void htmLogWeights(std::span<const glm::dvec3> directions, glm::dvec3 viewDirection, double gamma,
                   std::span<double> logs) {
  constexpr double kLeast = 1e-30;
  const glm::dvec3 a = unit(viewDirection);
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const glm::dvec3 b = unit(directions[i]);
    const double plus = glm::dot(a + b, a + b), minus = glm::dot(a - b, a - b);
    const double sine = minus / (plus + minus), cosine = plus / (plus + minus);  // sin² and cos² of the half angle
    logs[i] = gamma * (sine < 0.5 ? std::log1p(-sine) : std::log(std::max(cosine, kLeast)));
    largest = std::max(largest, logs[i]);
  }
  for (double& log : logs) log -= largest;
}

}  // namespace ibr
