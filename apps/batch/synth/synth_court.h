// SPDX-License-Identifier: Apache-2.0
// `ibr synth court`: any number of photographs to build a scene from.
#pragma once

#include <string>

#include "batch/command.h"
#include "shared/cli/options.h"

namespace ibr::app {

struct CourtOptions {
  std::string output;
  int photographs, views;  // views: of the truth
  PictureSize size;        // 0: 640 × 480
};

/// Writes images/*.jpg, sparse (a COLMAP model with tracks), and truth as ibr eval reads it.
ExitCode synthesiseCourt(const CourtOptions& options, const Context& context);

}  // namespace ibr::app
