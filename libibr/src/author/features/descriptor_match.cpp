// SPDX-License-Identifier: Apache-2.0
//
// Descriptor distances dominate the time of sparse matching: this file is compiled with vectors, see CMakeLists.txt.
#include <algorithm>
#include <limits>

#include "author/features/features.h"

namespace ibr {
namespace {

constexpr int kInfiniteDistance = std::numeric_limits<int>::max();
constexpr std::uint32_t kNoMatch = std::numeric_limits<std::uint32_t>::max();

int squareDistance(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto off = std::int16_t(a[k] - b[k]);
    sum += int(off) * int(off);
  }
  return sum;
}

struct Nearest {
  std::uint32_t feature = kNoMatch;
  int distance = kInfiniteDistance, second = kInfiniteDistance;  // second: of another feature

  void offer(std::uint32_t f, int d) {
    if (d < distance) {
      second = distance;
      distance = d;
      feature = f;
    } else if (d < second) {
      second = d;
    }
  }
};

}  // namespace

int descriptorDistance(const Features& a, std::size_t featureA, const Features& b, std::size_t featureB) {
  int least = kInfiniteDistance;
  for (std::uint32_t i = a.first[featureA]; i < a.first[featureA + 1]; ++i)
    for (std::uint32_t j = b.first[featureB]; j < b.first[featureB + 1]; ++j)
      least = std::min(least, squareDistance(a.descriptor[i], b.descriptor[j]));
  return least;
}

std::vector<FeatureMatch> mutualMatches(const Features& a, const Features& b, double ratio,
                                        const std::vector<bool>& takenA, const std::vector<bool>& takenB) {
  std::vector<std::uint32_t> free;
  for (std::uint32_t g = 0; g < b.count(); ++g)
    if (takenB.empty() || !takenB[g]) free.push_back(g);
  std::vector<Nearest> ofA(a.count()), ofB(b.count());
  constexpr std::size_t kTile = 64;  // number of b's features that stay in the cache
  for (std::size_t start = 0; start < free.size(); start += kTile)
    for (std::uint32_t f = 0; f < a.count(); ++f) {
      if (!takenA.empty() && takenA[f]) continue;
      for (std::size_t k = start; k < std::min(start + kTile, free.size()); ++k) {
        const std::uint32_t g = free[k];
        const int d = descriptorDistance(a, f, b, g);
        ofA[f].offer(g, d);
        ofB[g].offer(f, d);
      }
    }
  std::vector<FeatureMatch> matches;
  for (std::uint32_t f = 0; f < a.count(); ++f) {
    const Nearest& n = ofA[f];
    if (n.feature == kNoMatch || ofB[n.feature].feature != f) continue;
    if (double(n.distance) > ratio * ratio * double(n.second)) continue;
    matches.push_back({f, n.feature, n.distance});
  }
  return matches;
}

}  // namespace ibr
