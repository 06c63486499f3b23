// SPDX-License-Identifier: Apache-2.0
// Enhanced correlation coefficient of two lists of samples, from sums that can be taken apart and merged ([T] §3.5,
// eqs 1–8). With M(x, y) = n·Σxy − Σx·Σy of a channel and target k,
//
//   ECC = Σ_k M_k(x, y)/n_k / √(Σ_k M_k(x, x)/n_k · Σ_k M_k(y, y)/n_k)
//
// Departures: [T] concatenates channels and targets and subtracts one common mean; then the offset between channels
// dominates, and unrelated textures of one colour score above 0.9 (NUMERICS §1 (c)). [T] eq. 9 shifts each product
// right so that 32 bits hold the sums, and eq. 8 is evaluated in floats; here sums and moments are exact (T1–T4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/ecc.h"

namespace ibr {

struct Ecc {
  double value = 0;      // within [-1, 1]; 0 where undefined
  bool defined = false;  // false: nothing to correlate, that is fewer than two samples or a constant list
};

/// [T]'s six accumulators, of one channel of one target. Values are whole numbers of any unit, at most 2¹⁶ in size
/// (grey levels; grey levels in 2⁻⁸, also about mid-grey). 2²⁴ samples a tuple and twelve merged tuples are exact.
struct PreEcc {
  std::int64_t n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;

  void add(std::int64_t a, std::int64_t b) {
    ++n;
    x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  void merge(const PreEcc& other) {
    n += other.n, x += other.x, y += other.y, xx += other.xx, yy += other.yy, xy += other.xy;
  }
  bool operator==(const PreEcc&) const = default;
};

/// ECC of a source (x) and its targets (y), a tuple for each channel and target, to a few units in the last place.
/// `concatenated` merges them to one. `varianceFloor` (the values' unit squared, >= 0) belongs to `channels`: it is
/// added to the covariance and to both variances of each sample; with it flat patches that are alike score high instead
/// of being undefined, and noise on them weighs little (25 grey² in our filters). Tuples without samples count for
/// nothing; where none has two, the ECC is undefined.
Ecc ecc(std::span<const PreEcc> sums, EccDefinition definition = EccDefinition::channels,
        std::int64_t varianceFloor = 0);

/// Whether a's ECC is truly greater than b's, decided in whole numbers; what is undefined is less than all that is
/// defined. The first of the best candidates is found by going through them in order. Throws Error{invalidInput} where
/// the tuples of a or b have more than three different sample counts (a target has one).
bool eccGreater(std::span<const PreEcc> a, std::span<const PreEcc> b,
                EccDefinition definition = EccDefinition::channels, std::int64_t varianceFloor = 0);

/// ECC of RGB samples that are no whole numbers (interpolated, 0 to 255), by `channels`. Sums are taken about the first
/// sample, so they lose nothing to cancellation. A variance below 1e-6 grey² counts as constant: it is rounding, not
/// texture. Values that are not finite make it undefined.
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
