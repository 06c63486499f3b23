// SPDX-License-Identifier: Apache-2.0
// Pseudo-random numbers that do not depend on the standard library; the std:: distributions do.
#pragma once

#include <cstdint>
#include <random>

namespace ibr {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform in [low, high), but for rounding; multiples of 2⁻⁵³ (high − low).
  double uniform(double low, double high) { return low + (high - low) * double(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ibr
