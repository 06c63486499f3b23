// SPDX-License-Identifier: Apache-2.0
// How well the colours of different cells fit together: what colour mapping is for ([T] §2.5.3).
#pragma once

#include <cmath>

#include "ibr/image.h"

namespace ibr::app {

/// Mean step between neighbouring pixels of tier 0 that different cells drew, less the truth's step there; NaN where no
/// two cells meet.
struct SeamStep {
  double levels = NAN;  // of 255, mean over channels
  double deltaE = NAN;  // ΔE*ab
};
/// `surface`: FrameBuffers::surface of the picture.
SeamStep seamStep(const Image8& picture, const ImageF& surface, const Image8& truth);

/// The picture (RGB) after each channel was multiplied, in linear light, by one gain: the median over the mask of the
/// truth's value over the picture's, clipped pixels left out. The exposure of a picture is a matter of taste; how it
/// changes within it is not.
Image8 gainFitted(const Image8& picture, const Image8& truth, const Image8& mask);

/// Mean ΔE*ab over the mask of what gainFitted gives.
double gainFreeDeltaE(const Image8& picture, const Image8& truth, const Image8& mask);

}  // namespace ibr::app
