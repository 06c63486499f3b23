// SPDX-License-Identifier: Apache-2.0
#include "image/ecc.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace ibr {
namespace {

// Moments are means over samples and channels, grey².
Ecc fromMoments(std::size_t samples, double covariance, double varianceA, double varianceB, double floor) {
  constexpr double kConstant = 1e-6;
  if (samples < 2 || !(varianceA + floor > kConstant) || !(varianceB + floor > kConstant)) return {};
  const double value = (covariance + floor) / (std::sqrt(varianceA + floor) * std::sqrt(varianceB + floor));
  if (!std::isfinite(value)) return {};
  return {std::clamp(value, -1.0, 1.0), true};
}

__extension__ using Wide = __int128;

}  // namespace

Ecc ecc(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, double varianceFloor) {
  check(a.size() == b.size() && a.size() % 3 == 0, ErrorCode::invalidInput,
        "ECC of {} and {} values: not equally many RGB samples", a.size(), b.size());
  const std::size_t samples = a.size() / 3;
  Wide covariance = 0, varianceA = 0, varianceB = 0;  // times samples²
  for (std::size_t c = 0; c < 3; ++c) {
    std::uint64_t sumA = 0, sumB = 0, sumAA = 0, sumBB = 0, sumAB = 0;
    for (std::size_t i = c; i < a.size(); i += 3) {
      const std::uint64_t p = a[i], q = b[i];
      sumA += p, sumB += q, sumAA += p * p, sumBB += q * q, sumAB += p * q;
    }
    covariance += Wide(samples) * sumAB - Wide(sumA) * sumB;
    varianceA += Wide(samples) * sumAA - Wide(sumA) * sumA;
    varianceB += Wide(samples) * sumBB - Wide(sumB) * sumB;
  }
  if (samples == 0) return {};
  const double scale = 1.0 / (3.0 * double(samples) * double(samples));
  return fromMoments(samples, double(covariance) * scale, double(varianceA) * scale, double(varianceB) * scale,
                     varianceFloor);
}

void EccSums::add(glm::dvec3 a, glm::dvec3 b) {
  if (count_++ == 0) originA_ = a, originB_ = b;
  a -= originA_;
  b -= originB_;
  sumA_ += a;
  sumB_ += b;
  sumAA_ += glm::dot(a, a);
  sumBB_ += glm::dot(b, b);
  sumAB_ += glm::dot(a, b);
}

Ecc EccSums::result(double varianceFloor) const {
  if (count_ == 0) return {};
  const double n = double(count_), scale = 1.0 / (3.0 * n);
  return fromMoments(count_, (sumAB_ - glm::dot(sumA_, sumB_) / n) * scale,
                     (sumAA_ - glm::dot(sumA_, sumA_) / n) * scale, (sumBB_ - glm::dot(sumB_, sumB_) / n) * scale,
                     varianceFloor);
}

}  // namespace ibr
