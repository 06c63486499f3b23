// SPDX-License-Identifier: Apache-2.0
// How right the depth is that a picture was drawn with.
#pragma once

#include "ibr/image.h"
#include "ibr/offscreen.h"

namespace ibr::app {

/// How wrong a drawn depth may be.
struct DepthTolerance {
  double focalPx = 0;   // of the view
  double baseline = 0;  // world units: a depth is right where seen from so far beside it moves by at most 1 px
};

/// Shares of the pixels that are not sky in the truth. What nothing was drawn at is none of the three. NaN where all is
/// sky.
struct DepthScores {
  double right, tooFar, tooNear;
};

/// `inverseDepth`: along the axis, negative where nothing was drawn; `truth`: depth along the axis, world units, 0 for
/// the sky. Precondition: one channel each, equal sizes.
DepthScores depthScores(const ImageF& inverseDepth, const ImageF& truth, const DepthTolerance& tolerance);

/// Shares of the confirmed pixels (tier 0) whose true inverse depth lies within one and two of their standard
/// deviations from the one that was drawn; those are left out that are sky in the truth. NaN where none is left.
struct DeviationScores {
  double one, two;
};
DeviationScores deviationScores(const FrameBuffers& buffers, const ImageF& truth);

/// Inverse depth that a renderer drew, negative where it drew nothing.
ImageF drawnInverseDepth(const FrameBuffers& buffers);

/// Share of the pixels whose depth was guessed: completed between matches,
/// filled in the view, or empty.
double guessedShare(const FrameBuffers& buffers);

}  // namespace ibr::app
