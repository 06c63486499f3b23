// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth moving`: 3D video with exact truth.
#pragma once

#include <string>

#include "batch/command.h"
#include "shared/cli/options.h"

namespace ibr::app {

struct MovingOptions {
  std::string output;
  int frames, views;  // views: of the truth, for each frame
  PictureSize size;   // 0: 512 × 512
};

ExitCode synthesiseMoving(const MovingOptions& options, const Context& context);

}  // namespace ibr::app
