// SPDX-License-Identifier: Apache-2.0
// Accuracy of the depth of a rendered image.
#pragma once

#include "ibr/image.h"
#include "ibr/offscreen.h"

namespace ibr::app {

/// Tolerance of a drawn depth.
struct DepthTolerance {
  double focalPx = 0;   // focal length of the view, px
  double baseline = 0;  // world units: a depth is right if it moves the pixel by at most 1 px in a view this far beside
};

/// Shares of the pixels that are not sky in the truth. Pixels where nothing is drawn count in none of the three. NaN:
/// all pixels are sky.
struct DepthScores {
  double right, tooFar, tooNear;
};

/// `inverseDepth`: along the axis, negative where nothing is drawn. `truth`: depth along the axis, world units, 0 for
/// the sky. Precondition: one channel each, equal sizes.
DepthScores depthScores(const ImageF& inverseDepth, const ImageF& truth, const DepthTolerance& tolerance);

/// Shares of the confirmed pixels (tier 0) whose true inverse depth lies within one and two of their standard
/// deviations of the drawn one. Pixels that are sky in the truth do not count. NaN: no pixel counts.
struct DeviationScores {
  double one, two;
};
DeviationScores deviationScores(const FrameBuffers& buffers, const ImageF& truth);

/// Returns the inverse depth that a renderer drew, negative where nothing is drawn.
ImageF drawnInverseDepth(const FrameBuffers& buffers);

/// Returns the share of the pixels without confirmed depth: completed between matches,
/// filled in the view, or empty.
double guessedShare(const FrameBuffers& buffers);

}  // namespace ibr::app
