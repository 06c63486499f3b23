// SPDX-License-Identifier: Apache-2.0
// New views of a harmonised model or of 3D video as PNG files: `ibr htm render`, and `ibr render` of such a thing.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "batch/command.h"
#include "ibr/asset.h"
#include "ibr/htm.h"
#include "shared/cli/options.h"

namespace ibr::app {

struct HtmViewsOptions {
  std::string model;  // or sequence
  std::string poses, output;
  int autoFrames = 0;  // 0: not asked for
  PictureSize size;
  double fovDegrees = 0;  // 0: that of the poses
  bool onSource = false;
  bool graph = false;
  std::optional<double> time;  // s, of all views; none: the poses'
  HtmSettings settings;
};

/// --method, --mesh, --gamma, --weight-cut, --smooth and --time.
void declareHtmViews(CLI::App& app, HtmViewsOptions& options);

/// Throws CLI::ValidationError for what `kind` has not.
void checkHtmViews(const HtmViewsOptions& options, std::optional<AssetKind> kind);

/// Throws Error.
ExitCode renderHtmViews(const HtmViewsOptions& options, const Context& context);

}  // namespace ibr::app
