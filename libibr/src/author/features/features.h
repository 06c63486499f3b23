// SPDX-License-Identifier: Apache-2.0
// Sparse features everywhere in a picture, and their matches by descriptor.
//
// SIFT (Lowe 2004) with a low threshold; of each square of a grid the strongest are kept, so that weak texture has
// features too and strong texture not all of them. One place may have several orientations: its descriptors are joined
// in one feature, whose distance from another is that of the nearest two. Descriptors are rooted (Arandjelović &
// Zisserman 2012).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

using Descriptor = std::array<std::int16_t, 128>;  // 0 … 512; its square sum is about 512²

struct Features {
  std::vector<glm::vec2> at;            // px, in an order that depends on the picture only
  std::vector<std::uint32_t> first{0};  // descriptors first[f] … first[f + 1] − 1 are those of feature f
  std::vector<Descriptor> descriptor;

  std::size_t count() const { return at.size(); }
};

/// `grey`: 1 channel. About `most` features at most. A picture without texture has none.
Features detectFeatures(const Image8& grey, int most);

struct FeatureMatch {
  std::uint32_t a, b;
  int distance;  // square distance of descriptors, see descriptorDistance
};

/// Each feature of `a` and the feature of `b` nearest to it, where the second nearest is farther by 1/`ratio` and where
/// it is the other's nearest, too. Features with `takenA` or `takenB` set are left out (empty: none is). In order of a.
std::vector<FeatureMatch> mutualMatches(const Features& a, const Features& b, double ratio,
                                        const std::vector<bool>& takenA = {}, const std::vector<bool>& takenB = {});

/// Square distance of the nearest two descriptors of two features; 0 … 2·512² about.
int descriptorDistance(const Features& a, std::size_t featureA, const Features& b, std::size_t featureB);

}  // namespace ibr
