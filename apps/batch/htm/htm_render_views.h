// SPDX-License-Identifier: Apache-2.0
// Renders views of a harmonised model or of 3D video to PNG files, for `ibr htm render` and `ibr render`.
#pragma once

#include <optional>
#include <string>

#include "batch/command.h"
#include "batch/files/rendered_views.h"
#include "ibr/asset.h"
#include "ibr/htm.h"

namespace ibr::app {

struct HtmViewsOptions : RenderedViews {
  std::string model;  // or sequence
  bool sourceMesh = false;
  std::optional<double> time;  // s, for all views; nullopt: the times of the poses
  HtmSettings settings;
};

/// Declares --method, --mesh, --gamma, --weight-cut, --smooth and --time.
void declareHtmViews(CLI::App& app, HtmViewsOptions& options);

/// Refuses options that do not apply to `kind`.
void checkHtmViews(const HtmViewsOptions& options, std::optional<AssetKind> kind);

/// Renders and writes all views. Throws Error.
ExitCode renderHtmViews(const HtmViewsOptions& options, const Context& context);

}  // namespace ibr::app
