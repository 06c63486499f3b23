// SPDX-License-Identifier: Apache-2.0
// Enhanced correlation coefficient of two lists of RGB samples ([T] §3.5, eqs 1–3).
//
//   ECC = Σ_c cov_c(a, b) / √(Σ_c var_c(a) · Σ_c var_c(b)),  sums over channels c, moments about each channel's own
//   mean
//
// Departure: [T] concatenates the channels and subtracts one common mean; then the offset between channels dominates,
// and unrelated textures of one colour score above 0.9 (NUMERICS §1 (c)).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace ibr {

struct Ecc {
  double value = 0;      // within [-1, 1]; 0 where undefined
  bool defined = false;  // false: fewer than two samples, a constant list, or values that are not finite
};

/// Exact sums over interleaved 8-bit RGB samples, equally many in both lists. `varianceFloor` (grey², >= 0) is added to
/// the covariance and to both variances, each taken as the mean over samples and channels; with it flat patches that
/// are alike score high instead of being undefined, and noise on them weighs little (25 in our filters). Throws
/// Error{invalidInput} where the lists differ in length or do not hold whole pixels.
Ecc ecc(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, double varianceFloor = 0);

/// The same, sample by sample, for interpolated values (0 to 255). Sums are taken about the first sample, so they lose
/// nothing to cancellation. A variance below 1e-6 grey² counts as constant: it is rounding, not texture.
class EccSums {
 public:
  void add(glm::dvec3 a, glm::dvec3 b);
  std::size_t count() const { return count_; }
  Ecc result(double varianceFloor = 0) const;

 private:
  std::size_t count_ = 0;
  glm::dvec3 originA_{0.0}, originB_{0.0};
  glm::dvec3 sumA_{0.0}, sumB_{0.0};
  double sumAA_ = 0, sumBB_ = 0, sumAB_ = 0;
};

}  // namespace ibr
