// SPDX-License-Identifier: Apache-2.0
// `ibr synth noise`: a model whose poses are off by a known amount, to measure what refining recovers.
#pragma once

#include <string>

#include "batch/command.h"

namespace ibr::app {

/// Normal deviations.
struct NoiseOptions {
  std::string model, output;
  double pixels = 1;        // of rotations: root mean square of how far they move the picture's middle
  double shift = 0;         // of positions: root mean square, world units
  double focalPercent = 0;  // all focal lengths grow by
  double trackPixels = 0;   // of observations, along each axis
  bool tracks = true;       // false: left out
};

/// Points are placed anew where the poses see them best; those that they do not see are left out.
ExitCode synthesiseNoise(const NoiseOptions& options, const Context& context);

}  // namespace ibr::app
