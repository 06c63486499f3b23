// SPDX-License-Identifier: Apache-2.0
// Options of the commands that render views to a folder: `ibr render`, `ibr htm render`.
#pragma once

#include <string>

#include "shared/cli/options.h"

namespace ibr::app {

struct RenderedViews {
  std::string poses, output;
  int autoFrames = 0;  // 0: not requested
  PictureSize size;
  double fovDegrees = 0;  // 0: as the poses
  bool graph = false;
};

/// Declares --poses, --path, --output, --size, --fov and --graph.
void declareRenderedViews(CLI::App& app, RenderedViews& views);

/// Refuses options without --poses and without --path.
void requireViews(const RenderedViews& views);

}  // namespace ibr::app
