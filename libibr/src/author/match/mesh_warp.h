// SPDX-License-Identifier: Apache-2.0
// Dense map between two images from sparse matches: the dominant homography, corrected by linear interpolation between
// matches.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Matched points, px of either image.
struct PointPairs {
  std::vector<glm::vec2> from, to;
};

/// Returns 2 channels of size `size`: each pixel's position in the second image. Outliers of the epipolar geometry, and
/// of their neighbourhood, are left out. With too few matches the second image is stretched over the first.
/// Deterministic.
ImageF meshWarp(const PointPairs& pairs, glm::ivec2 size, glm::ivec2 otherSize);

}  // namespace ibr
