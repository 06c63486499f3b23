// SPDX-License-Identifier: Apache-2.0
//
// The closest point of a simplex to a point p outside lies on a face that p is beyond: a face without a corner whose
// weight is negative. The search descends into these faces only. A degenerate simplex is searched in all its faces.
#include "render/plan/barycentric.h"

#include <algorithm>
#include <array>
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

template <std::size_t kCorners>
using Simplex = std::array<glm::dvec3, kCorners>;

template <std::size_t kCorners>
[[gnu::always_inline]] inline Simplex<kCorners - 1> faceWithout(std::size_t corner, const Simplex<kCorners>& simplex) {
  Simplex<kCorners - 1> face;
  for (std::size_t i = 0; i + 1 < kCorners; ++i) face[i] = simplex[i < corner ? i : i + 1];
  return face;
}

// Weights of a simplex's corners from those of its face without a corner.
[[gnu::always_inline]] inline Weights ofSimplex(std::size_t corner, const Weights& ofFace) {
  Weights weights{};
  for (std::size_t i = 0; i + 1 < weights.size(); ++i) weights[i < corner ? i : i + 1] = ofFace[i];
  return weights;
}

// Returns λ of the projection of p on the simplex's span; nullopt if the corners are degenerate.
template <std::size_t kCorners>
[[gnu::always_inline]] inline std::optional<Weights> projected(const Simplex<kCorners>& corners, glm::dvec3 p) {
  const glm::dvec3 w = p - corners[0];
  Weights weights{};
  if constexpr (kCorners == 2) {  // eq. 1
    const glm::dvec3 e = corners[1] - corners[0];
    const double squared = dot(e, e);
    if (!(squared > 0.0)) return std::nullopt;
    weights[1] = dot(w, e) / squared;
  } else if constexpr (kCorners == 3) {  // eqs 2, 3
    const glm::dvec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], normal = cross(e1, e2);
    const double squared = dot(normal, normal);
    if (!(std::sqrt(squared) > kFlat * glm::length(e1) * glm::length(e2))) return std::nullopt;
    weights[1] = dot(cross(w, e2), normal) / squared;
    weights[2] = dot(cross(e1, w), normal) / squared;
  } else if constexpr (kCorners == 4) {
    const glm::dvec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], e3 = corners[3] - corners[0];
    const double volume = dot(e1, cross(e2, e3));
    if (!(std::abs(volume) > kFlat * glm::length(e1) * glm::length(e2) * glm::length(e3))) return std::nullopt;
    weights[1] = dot(w, cross(e2, e3)) / volume;
    weights[2] = dot(w, cross(e3, e1)) / volume;
    weights[3] = dot(w, cross(e1, e2)) / volume;
  }
  double rest = 1.0;
  for (std::size_t i = 1; i < kCorners; ++i) {
    if (!std::isfinite(weights[i])) return std::nullopt;
    rest -= weights[i];
  }
  weights[0] = rest;
  return weights;
}

template <std::size_t kCorners>
[[gnu::always_inline]] inline double squaredDistance(const Simplex<kCorners>& corners, const Weights& weights,
                                                     glm::dvec3 p) {
  glm::dvec3 offset(0.0);
  for (std::size_t i = 0; i < kCorners; ++i) offset += weights[i] * (corners[i] - p);
  return glm::dot(offset, offset);
}

[[gnu::always_inline]] inline bool inside(const Weights& weights) {
  return std::min(std::min(weights[0], weights[1]), std::min(weights[2], weights[3])) >= 0.0;
}

struct ClosestPoint {
  Weights weights{};
  double squaredDistance = std::numeric_limits<double>::infinity();
};

// `free`: projected(corners, p).
template <std::size_t kCorners>
[[gnu::always_inline]] inline ClosestPoint closestPoint(const Simplex<kCorners>& corners,
                                                        const std::optional<Weights>& free, glm::dvec3 p) {
  if (free && inside(*free)) return {*free, squaredDistance(corners, *free, p)};
  ClosestPoint closest;
  if constexpr (kCorners > 1)
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      if (free && (*free)[corner] >= 0.0) continue;
      const Simplex<kCorners - 1> face = faceWithout(corner, corners);
      const ClosestPoint onFace = closestPoint(face, projected(face, p), p);
      if (onFace.squaredDistance < closest.squaredDistance)
        closest = {ofSimplex(corner, onFace.weights), onFace.squaredDistance};
    }
  return closest;
}

// λ of the projection on a face of a degenerate simplex.
struct LargestFace {
  Weights weights{};
  std::pair<std::size_t, double> size;  // number of corners, sum of squared distances between them
};

template <std::size_t kCorners>
LargestFace largestFace(const Simplex<kCorners>& corners, glm::dvec3 p) {
  if (const std::optional<Weights> weights = projected(corners, p)) {
    double spread = 0;
    for (std::size_t i = 0; i < kCorners; ++i)
      for (std::size_t j = 0; j < i; ++j) spread += glm::dot(corners[i] - corners[j], corners[i] - corners[j]);
    return {*weights, {kCorners, spread}};
  }
  LargestFace largest;
  if constexpr (kCorners > 1)
    for (std::size_t corner = kCorners; corner-- > 0;)
      if (const LargestFace face = largestFace(faceWithout(corner, corners), p); face.size > largest.size)
        largest = {ofSimplex(corner, face.weights), face.size};
  return largest;
}

template <std::size_t kCorners>
[[gnu::always_inline]] inline Barycentric barycentricOf(const glm::dvec3* first, glm::dvec3 p) {
  Simplex<kCorners> corners;
  for (std::size_t i = 0; i < kCorners; ++i) corners[i] = first[i];
  const std::optional<Weights> free = projected(corners, p);
  const ClosestPoint closest = closestPoint(corners, free, p);
  return {.free = free ? *free : largestFace(corners, p).weights,
          .clamped = closest.weights,
          .distance = std::sqrt(closest.squaredDistance),
          .degenerate = !free};
}

[[gnu::always_inline]] inline Barycentric closest(const glm::dvec3* corners, std::size_t count, glm::dvec3 p) {
  switch (count) {
    case 1:
      return barycentricOf<1>(corners, p);
    case 2:
      return barycentricOf<2>(corners, p);
    case 3:
      return barycentricOf<3>(corners, p);
    default:
      return barycentricOf<4>(corners, p);
  }
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
