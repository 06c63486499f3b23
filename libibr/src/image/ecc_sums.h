// SPDX-License-Identifier: Apache-2.0
// Enhanced correlation coefficient of two lists of samples, from sums that can be split and merged ([T] §3.5, eqs 1–8).
// With M(x, y) = n·Σxy − Σx·Σy of a channel and target k,
//
//   ECC = Σ_k M_k(x, y)/n_k / √(Σ_k M_k(x, x)/n_k · Σ_k M_k(y, y)/n_k)
//
// Departures: [T] concatenates channels and targets and subtracts one common mean. Then the offset between channels
// dominates, and unrelated textures of one colour score above 0.9. [T] eq. 9 shifts products right so that 32 bits hold
// the sums, and [T] eq. 8 is evaluated in floats; here sums and moments are exact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/ecc.h"

namespace ibr {

struct Ecc {
  double value = 0;      // in [-1, 1]; 0 if undefined
  bool defined = false;  // false: fewer than two samples, or a constant list
};

/// Six accumulators of [T] for one channel of one target. Values are integers of any unit, at most 2¹⁶ in magnitude
/// (8-bit levels; 2⁻⁸ of them, also about mid-grey). Exact for 2²⁴ samples per tuple and twelve merged tuples.
struct EccMoments {
  std::int64_t n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;

  void add(std::int64_t a, std::int64_t b) {
    ++n;
    x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  void merge(const EccMoments& other) {
    n += other.n, x += other.x, y += other.y, xx += other.xx, yy += other.yy, xy += other.xy;
  }
  bool operator==(const EccMoments&) const = default;
};

/// ECC of a source (x) and its targets (y), one tuple per channel and target, to a few units in the last place.
/// `concatenated` merges all tuples. `varianceFloor` (squared units of the values, >= 0) belongs to `channels`: it is
/// added to the covariance and both variances of each sample. With a floor, similar flat patches score high instead of
/// being undefined, and their noise weighs little (the filters use 25 grey²). Tuples without samples are ignored; if no
/// tuple has two samples, the ECC is undefined.
Ecc ecc(std::span<const EccMoments> sums, EccDefinition definition = EccDefinition::channels,
        std::int64_t varianceFloor = 0);

/// Compares the ECC of a and b exactly, in integers: true if a's is greater; undefined is less than any defined value.
/// A scan in order thus finds the first of the best candidates. Throws Error{invalidInput} if the tuples of a or b have
/// more than three different sample counts (a target has one).
bool eccGreater(std::span<const EccMoments> a, std::span<const EccMoments> b,
                EccDefinition definition = EccDefinition::channels, std::int64_t varianceFloor = 0);

/// ECC of RGB samples that are not integers (interpolated, 0 to 255), as `channels`. Sums are relative to the first
/// sample, which avoids cancellation. A variance below 1e-6 grey² counts as constant, since rounding causes that much.
/// Values that are not finite make the ECC undefined.
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
