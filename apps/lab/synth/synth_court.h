// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth court`: any number of photographs, as input for builds.
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

/// Writes images/*.jpg, sparse (a COLMAP model with tracks), and the truth in the format of ibr eval.
ExitCode synthesiseCourt(const CourtOptions& options, const Context& context);

}  // namespace ibr::app
