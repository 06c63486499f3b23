// SPDX-License-Identifier: Apache-2.0
// Sparse features all over an image, and their matches by descriptor.
//
// SIFT (Lowe 2004) with a low threshold. Of each square of a grid the strongest features are kept, so that weak texture
// is covered and strong texture does not dominate. A keypoint with several orientations is one feature with several
// descriptors. The distance of two features is that of their nearest descriptors. Descriptors are rooted (Arandjelović
// & Zisserman 2012).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

using Descriptor = std::array<std::int16_t, 128>;  // 0 … 512; the sum of squares is about 512²

struct Features {
  std::vector<glm::vec2> at;            // px, in an order that depends on the image only
  std::vector<std::uint32_t> first{0};  // descriptors of feature f: first[f] … first[f + 1] − 1
  std::vector<Descriptor> descriptor;

  std::size_t count() const { return at.size(); }
};

/// `grey`: 1 channel. Finds about `most` features at most; none in an image without texture.
Features detectFeatures(const Image8& grey, int most);

struct FeatureMatch {
  std::uint32_t a, b;
  int distance;  // squared distance of descriptors, see descriptorDistance
};

/// Mutually nearest features, where the second nearest is farther by 1/`ratio`. Features with `takenA` or `takenB` set
/// are excluded (empty: none is). In order of a.
std::vector<FeatureMatch> mutualMatches(const Features& a, const Features& b, double ratio,
                                        const std::vector<bool>& takenA = {}, const std::vector<bool>& takenB = {});

/// Squared distance of the nearest two descriptors of two features; 0 to about 2·512².
int descriptorDistance(const Features& a, std::size_t featureA, const Features& b, std::size_t featureB);

}  // namespace ibr
