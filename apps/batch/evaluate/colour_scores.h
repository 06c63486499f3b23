// SPDX-License-Identifier: Apache-2.0
// Scores of how well the colours of different cells match, which colour mapping improves ([T] §2.5.3).
#pragma once

#include <cmath>

#include "ibr/image.h"

namespace ibr::app {

/// Mean difference between neighbouring tier-0 pixels of different cells, minus the truth's difference there; NaN if no
/// two cells meet.
struct SeamStep {
  double levels = NAN;  // 8-bit levels, mean over channels
  double deltaE = NAN;  // ΔE*ab
};
/// `surface`: FrameBuffers::surface of the image.
SeamStep seamStep(const Image8& picture, const ImageF& surface, const Image8& truth);

/// Returns the mean ΔE*ab over the mask after gainFitted (ibr/view_scores.h).
double gainFreeDeltaE(const Image8& picture, const Image8& truth, const Image8& mask);

}  // namespace ibr::app
