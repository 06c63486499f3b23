// SPDX-License-Identifier: Apache-2.0
//
//   energy(x) = Σ over ones y of exp(−|x − y|² / 2σ²), distances on the torus
//   1. start from a random tenth of ones; move the tightest cluster into the largest void until both are one pixel
//   2. rank these ones backwards by removing the tightest cluster; rank the rest forwards by filling the largest void
//
// Departure: past one half, Ulichney swaps the meaning of ones and zeros. Filling voids to the end gives the same
// spectrum at the sizes used here, without a third phase.
#include "image/blue_noise.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace ibr {
namespace {

class Energy {
 public:
  explicit Energy(int size) : size_(size), kernel_(count()), energy_(count(), 0.0), ones_(count(), false) {
    constexpr double kSigma = 1.9;  // pixels; Ulichney §3: the value at which the clusters are judged best
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const int dx = std::min(x, size - x), dy = std::min(y, size - y);
        kernel_[std::size_t(y * size + x)] = std::exp(-(dx * dx + dy * dy) / (2.0 * kSigma * kSigma));
      }
  }

  std::size_t count() const { return std::size_t(size_) * std::size_t(size_); }
  bool one(std::size_t at) const { return ones_[at]; }

  void set(std::size_t at, bool one) {
    ones_[at] = one;
    const int atX = int(at) % size_, atY = int(at) / size_;
    const double sign = one ? 1.0 : -1.0;
    for (int y = 0; y < size_; ++y) {
      const double* row = &kernel_[std::size_t(((y - atY + size_) % size_) * size_)];
      double* out = &energy_[std::size_t(y * size_)];
      for (int x = 0; x < size_; ++x) out[x] += sign * row[x < atX ? x - atX + size_ : x - atX];
    }
  }

  std::size_t tightestCluster() const {
    return extreme(true, [](double a, double b) { return a > b; });
  }
  std::size_t largestVoid() const {
    return extreme(false, [](double a, double b) { return a < b; });
  }

 private:
  template <class Better>
  std::size_t extreme(bool one, Better better) const {
    std::size_t found = count();
    for (std::size_t i = 0; i < count(); ++i)
      if (ones_[i] == one && (found == count() || better(energy_[i], energy_[found]))) found = i;
    return found;
  }

  int size_;
  std::vector<double> kernel_, energy_;
  std::vector<bool> ones_;
};

}  // namespace

std::vector<std::uint16_t> blueNoise(int size, std::uint64_t seed) {
  assert(size >= 8 && size <= 128);
  Energy pattern(size);
  std::mt19937_64 random(seed);
  const std::size_t start = pattern.count() / 10;
  for (std::size_t placed = 0; placed < start;) {
    const std::size_t at = random() % pattern.count();
    if (pattern.one(at)) continue;
    pattern.set(at, true);
    ++placed;
  }
  for (;;) {
    const std::size_t cluster = pattern.tightestCluster();
    pattern.set(cluster, false);
    const std::size_t gap = pattern.largestVoid();
    pattern.set(gap, true);
    if (gap == cluster) break;
  }
  std::vector<std::uint16_t> rank(pattern.count());
  Energy shrinking = pattern;
  for (std::size_t r = start; r-- > 0;) {
    const std::size_t at = shrinking.tightestCluster();
    shrinking.set(at, false);
    rank[at] = std::uint16_t(r);
  }
  for (std::size_t r = start; r < pattern.count(); ++r) {
    const std::size_t at = pattern.largestVoid();
    pattern.set(at, true);
    rank[at] = std::uint16_t(r);
  }
  return rank;
}

}  // namespace ibr
