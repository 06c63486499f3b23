// SPDX-License-Identifier: Apache-2.0
// Matches features of two posed photographs along epipolar lines, restricted to the part of a line in front of both
// cameras (Hartley and Zisserman 2004, chapter 9).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "author/features/features.h"
#include "ibr/camera.h"

namespace ibr {

struct GuidedOptions {
  double distancePx = 3.0;  // max distance from the line, px in b's image
  double ratio = 0.85;      // max ratio of the best descriptor distance to the next one elsewhere near the line (Lowe)
};

/// Mutually best matches, in order of a. Features are in px of the cameras: pinholes at different positions.
std::vector<FeatureMatch> matchGuided(const Camera& cameraA, const Features& a, const Camera& cameraB,
                                      const Features& b, const GuidedOptions& options = {});

}  // namespace ibr
