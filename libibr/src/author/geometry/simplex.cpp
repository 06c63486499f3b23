// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/simplex.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ibr {

std::vector<Simplex> faces(const Simplex& simplex) {
  std::vector<Simplex> result;
  for (std::size_t left = simplex.size(); left-- > 0;) {
    result.push_back(simplex);
    result.back().erase(result.back().begin() + std::ptrdiff_t(left));
  }
  return result;
}

double longestEdge(std::span<const glm::dvec3> corners) {
  double longest = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, glm::distance(corners[i], corners[j]));
  return longest;
}

double shape(std::span<const glm::dvec3> corners) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j, ++count) {
      const glm::dvec3 edge = corners[i] - corners[j];
      sum += glm::dot(edge, edge);
    }
  if (!(sum > 0)) return 0;
  const double square = sum / count;
  const glm::dvec3 a = corners[1] - corners[0];
  if (corners.size() == 2) return 1;
  const glm::dvec3 b = corners[2] - corners[0];
  if (corners.size() == 3) return 2.0 / std::sqrt(3.0) * glm::length(glm::cross(a, b)) / square;
  return std::sqrt(2.0) * std::abs(glm::dot(glm::cross(a, b), corners[3] - corners[0])) / std::pow(square, 1.5);
}

Location locate(std::span<const glm::dvec3> corners, glm::dvec3 point) {
  Location location;
  auto& w = location.weights;
  const glm::dvec3 p = point - corners[0], a = corners[1] - corners[0];
  if (corners.size() == 2) {
    w[1] = glm::dot(p, a) / glm::dot(a, a);
  } else if (corners.size() == 3) {
    const glm::dvec3 b = corners[2] - corners[0], normal = glm::cross(a, b);
    const double square = glm::dot(normal, normal);
    w[1] = glm::dot(glm::cross(p, b), normal) / square;
    w[2] = glm::dot(glm::cross(a, p), normal) / square;
  } else {
    assert(corners.size() == 4);
    const glm::dvec3 b = corners[2] - corners[0], c = corners[3] - corners[0];
    const double volume = glm::dot(glm::cross(a, b), c);
    w[1] = glm::dot(glm::cross(p, b), c) / volume;
    w[2] = glm::dot(glm::cross(a, p), c) / volume;
    w[3] = glm::dot(glm::cross(a, b), p) / volume;
  }
  w[0] = 1.0 - w[1] - w[2] - w[3];
  glm::dvec3 foot(0.0);
  for (std::size_t i = 1; i < corners.size(); ++i) foot += w[i] * (corners[i] - corners[0]);
  location.distance = glm::distance(p, foot);
  return location;
}

}  // namespace ibr
