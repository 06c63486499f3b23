// SPDX-License-Identifier: Apache-2.0
// The map from one picture to another that a few matches say: the dominant homography, and where matches lie, what is
// linear between them.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Matched points, px of either picture.
struct PointPairs {
  std::vector<glm::vec2> from, to;
};

/// 2 channels of `width` × `height`: where each pixel's centre of the first picture is seen in the second one. Outliers
/// of the epipolar geometry, and of what lies around them, are left out. Too few matches: the second picture stretched
/// over the first. Deterministic.
ImageF meshWarp(const PointPairs& pairs, glm::ivec2 size, glm::ivec2 otherSize);

}  // namespace ibr
