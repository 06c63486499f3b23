// SPDX-License-Identifier: Apache-2.0
//
// The closest point lies inside exactly one face (corner, edge, triangle, tetrahedron) on which p's projection has no
// negative weight; the nearest of all such faces contains the point. A simplex has at most 15 faces, so all are tried.
#include "render/plan/barycentric.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "base/wide.h"

namespace ibr {
namespace {

// Returns a·b − c·d with one rounding error of the result (Kahan; Jeannerod, Louvet, Muller 2013).
[[gnu::always_inline]] inline double differenceOfProducts(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) - std::fma(c, d, -cd);
}

[[gnu::always_inline]] inline glm::dvec3 cross(glm::dvec3 a, glm::dvec3 b) {
  return {differenceOfProducts(a.y, b.z, a.z, b.y), differenceOfProducts(a.z, b.x, a.x, b.z),
          differenceOfProducts(a.x, b.y, a.y, b.x)};
}

// Compensated dot product (Ogita, Rump, Oishi 2005).
[[gnu::always_inline]] inline double dot(glm::dvec3 a, glm::dvec3 b) {
  double sum = 0, correction = 0;
  for (int i = 0; i < 3; ++i) {
    const double product = a[i] * b[i], total = sum + product, part = total - sum;
    correction += std::fma(a[i], b[i], -product) + ((sum - (total - part)) + (product - part));
    sum = total;
  }
  return sum + correction;
}

constexpr double kFlat = 1e-14;  // relative thickness below which the corners are degenerate

/// Returns λ of the projection of p on the span of the corners chosen by `face` (one bit per corner); nullopt if the
/// corners are degenerate.
[[gnu::always_inline]] inline std::optional<Weights> projected(std::span<const glm::dvec3> corners, unsigned face,
                                                               glm::dvec3 p) {
  std::array<std::size_t, 4> index{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (face >> i & 1u) index[n++] = i;
  const glm::dvec3 origin = corners[index[0]], w = p - origin;
  std::array<glm::dvec3, 3> edge;  // from the origin to corners 1 … n−1
  for (std::size_t i = 1; i < n; ++i) edge[i - 1] = corners[index[i]] - origin;
  std::array<double, 3> part{};  // λ of corners 1 … n−1 of the face
  if (n == 2) {                  // eq. 1
    const glm::dvec3 e = edge[0];
    const double squared = dot(e, e);
    if (!(squared > 0.0)) return std::nullopt;
    part[0] = dot(w, e) / squared;
  } else if (n == 3) {  // eqs 2, 3
    const glm::dvec3 e1 = edge[0], e2 = edge[1], normal = cross(e1, e2);
    const double squared = dot(normal, normal);
    if (!(std::sqrt(squared) > kFlat * glm::length(e1) * glm::length(e2))) return std::nullopt;
    part[0] = dot(cross(w, e2), normal) / squared;
    part[1] = dot(cross(e1, w), normal) / squared;
  } else if (n == 4) {
    const auto [e1, e2, e3] = edge;
    const double volume = dot(e1, cross(e2, e3));
    if (!(std::abs(volume) > kFlat * glm::length(e1) * glm::length(e2) * glm::length(e3))) return std::nullopt;
    part[0] = dot(w, cross(e2, e3)) / volume;
    part[1] = dot(w, cross(e3, e1)) / volume;
    part[2] = dot(w, cross(e1, e2)) / volume;
  }
  Weights weights{};
  double rest = 1.0;
  for (std::size_t i = 1; i < n; ++i) {
    if (!std::isfinite(part[i - 1])) return std::nullopt;
    rest -= weights[index[i]] = part[i - 1];
  }
  weights[index[0]] = rest;
  return weights;
}

[[gnu::always_inline]] inline double squaredDistance(std::span<const glm::dvec3> corners, const Weights& weights,
                                                     glm::dvec3 p) {
  glm::dvec3 offset(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (weights[i] != 0.0) offset += weights[i] * (corners[i] - p);
  return glm::dot(offset, offset);
}

// Sum of squared distances between the corners of a face; picks the largest of several faces of one dimension.
[[gnu::always_inline]] inline double spread(std::span<const glm::dvec3> corners, unsigned face) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((face >> i & 1u) && (face >> j & 1u)) sum += glm::dot(corners[i] - corners[j], corners[i] - corners[j]);
  return sum;
}

[[gnu::always_inline]] inline bool inside(const Weights& weights) {
  for (double w : weights)
    if (w < 0.0) return false;
  return true;
}

[[gnu::always_inline]] inline Barycentric closest(const glm::dvec3* first, std::size_t count, glm::dvec3 p) {
  const std::span corners(first, count);
  const unsigned whole = (1u << count) - 1u;
  Barycentric result;
  const std::optional<Weights> free = projected(corners, whole, p);
  result.degenerate = !free;
  if (free) result.free = *free;
  if (free && inside(*free)) {
    result.clamped = *free;
    result.distance = std::sqrt(squaredDistance(corners, result.clamped, p));
    return result;
  }
  double nearest = std::numeric_limits<double>::infinity();
  std::pair<int, double> largest{0, -1.0};
  for (unsigned face = 1; face < whole; ++face) {
    const std::optional<Weights> weights = projected(corners, face, p);
    if (!weights) continue;
    if (result.degenerate)
      if (const std::pair size{std::popcount(face), spread(corners, face)}; size > largest) {
        largest = size;
        result.free = *weights;
      }
    if (!inside(*weights)) continue;
    if (const double squared = squaredDistance(corners, *weights, p); squared < nearest) {
      nearest = squared;
      result.clamped = *weights;
    }
  }
  result.distance = std::sqrt(nearest);
  return result;
}

}  // namespace

Barycentric barycentric(std::span<const glm::dvec3> corners, glm::dvec3 p) {
  assert(!corners.empty() && corners.size() <= 4);
  return runVectorised<closest>(corners.data(), corners.size(), p);
}

Weights smoothstep(const Weights& weights) {
  Weights result{};
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double x = weights[i];
    sum += result[i] = x * x * x * (x * (6.0 * x - 15.0) + 10.0);
  }
  for (double& w : result) w /= sum;
  return result;
}

}  // namespace ibr
