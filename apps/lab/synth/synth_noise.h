// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth noise`: adds known errors to a model's poses, to measure how well refinement removes them.
#pragma once

#include <string>

#include "batch/command.h"

namespace ibr::app {

/// Parameters of the noise, which is normally distributed.
struct NoiseOptions {
  std::string model, output;
  double pixels = 1;        // of rotations: RMS motion of the image's centre, px
  double shift = 0;         // of positions: RMS, world units
  double focalPercent = 0;  // growth of all focal lengths, %
  double trackPixels = 0;   // of observations along each axis, px
  bool tracks = true;       // false: tracks are left out
};

/// Triangulates the points again with the changed poses; drops points that the poses do not see.
ExitCode synthesiseNoise(const NoiseOptions& options, const Context& context);

}  // namespace ibr::app
