// SPDX-License-Identifier: Apache-2.0
// Sample textures, and a computation of the ECC by its definition.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "image/ecc_sums.h"

namespace ibr::test {

using Samples = std::vector<std::uint8_t>;  // interleaved if there are several channels

/// Table of 4096 normal deviates, indexed by a hash: drawing a sample takes a few nanoseconds.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
  double operator()() {
    state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
    return table()[(state_ * 0x2545f4914f6cdd1du) >> 52];
  }

 private:
  static const std::vector<double>& table() {
    static const std::vector<double> values = [] {
      std::mt19937 random(7);
      std::normal_distribution<double> normal;
      std::vector<double> list(4096);
      for (double& v : list) v = normal(random);
      return list;
    }();
    return values;
  }
  std::uint64_t state_;
};

inline std::uint8_t level(double value) {
  return std::uint8_t(std::clamp(std::lround(value), 0L, 255L));
}

/// Returns one tuple for each channel of two interleaved lists.
inline std::vector<EccMoments> preEcc(const Samples& a, const Samples& b, std::size_t channels = 3) {
  std::vector<EccMoments> sums(channels);
  for (std::size_t i = 0; i < a.size(); ++i) sums[i % channels].add(a[i], b[i]);
  return sums;
}

}  // namespace ibr::test
