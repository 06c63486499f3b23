// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth walk`: a hand-held video with exact poses and known blurred frames, as input of `ibr build`.
#pragma once

#include <cstdint>
#include <string>

#include "batch/command.h"
#include "shared/cli/options.h"

namespace ibr::app {

struct WalkVideoOptions {
  std::string output;
  double seconds = 60, fps = 30, shutter = 0.006;  // shutter: exposure of a frame, s
  bool variableRate = false;
  int views = 20;    // of the truth
  PictureSize size;  // 0: 640 × 360; even
};

/// Throws CLI::ValidationError for options that no walk can have.
void checkWalkVideoOptions(const WalkVideoOptions& options);

/// Writes walk.mp4 with the program ffmpeg, transforms.json with the pose of every frame, walk.json with facts of every
/// frame, and the truth in the format of ibr eval.
ExitCode synthesiseWalk(const WalkVideoOptions& options, const Context& context);

}  // namespace ibr::app
