// SPDX-License-Identifier: Apache-2.0
// Which features of two posed photographs show the same point: what one camera sees at a pixel, the other sees on a
// line, and of that on the part before both (Hartley and Zisserman 2004, chapter 9).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "author/features/features.h"
#include "ibr/camera.h"

namespace ibr {

struct GuidedOptions {
  double distancePx = 3.0;  // from the line, in b's picture
  double ratio = 0.85;      // of the best descriptor's distance to that of the next one elsewhere near the line (Lowe)
};

/// Matches that are each other's best, by a. Features are in px of the cameras, which are pinholes at different places.
std::vector<FeatureMatch> matchGuided(const Camera& cameraA, const Features& a, const Camera& cameraB,
                                      const Features& b, const GuidedOptions& options = {});

}  // namespace ibr
