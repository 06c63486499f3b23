// SPDX-License-Identifier: Apache-2.0
#include "optimise/ecc_step.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ibr {
namespace {

constexpr double kMinCurvature = 1e-3;  // grey²/px² per sample and channel; less is rounding noise
constexpr double kDamping = 1e-3;       // of the curvature; avoids a division by 0 along an edge

/// Inverse of the curvature, in all directions or along one.
glm::dmat2 inverseOf(const glm::dmat2& curvature, std::optional<glm::dvec2> direction) {
  if (!direction) return glm::inverse(curvature);
  return glm::outerProduct(*direction, *direction) / glm::dot(*direction, curvature * *direction);
}

/// Factor of the target at which the changed source matches best (eqs 16–19).
double scaleOf(const GradientSums& s, const glm::dmat2& inverse) {
  const double xx = glm::dot(s.xg, inverse * s.xg), xy = glm::dot(s.xg, inverse * s.yg),
               yy = glm::dot(s.yg, inverse * s.yg);  // of the part that a displacement can reach
  if (s.xy > xy) return (s.xx - xx) / (s.xy - xy);
  return std::max(std::sqrt(xx / yy), (xy - s.xy) / yy);
}

}  // namespace

std::optional<glm::dvec2> eccStep(const GradientSums& sums, const DisplacementPrior& prior, glm::dvec2 moved,
                                  std::optional<glm::dvec2> direction) {
  const double bend = sums.g00 + sums.g11;
  if (!(sums.xx > 0) || !(sums.yy > 0) || !(bend > kMinCurvature * sums.samples)) return std::nullopt;
  // 1 − ECC is half the squared distance of the two unit-length signals; costs are subtracted from their covariance.
  const glm::dmat2 cost = prior.cost * (2 * sums.samples * std::sqrt(sums.xx / sums.yy));
  const glm::dmat2 curvature = glm::dmat2(sums.g00, sums.g01, sums.g01, sums.g11) + cost + glm::dmat2(kDamping * bend);
  const glm::dmat2 inverse = inverseOf(curvature, direction);
  const glm::dvec2 step = inverse * (sums.yg * scaleOf(sums, inverse) - sums.xg - cost * moved);
  if (!std::isfinite(step.x) || !std::isfinite(step.y)) return std::nullopt;
  return step;
}

}  // namespace ibr
