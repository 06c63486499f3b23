// SPDX-License-Identifier: Apache-2.0
// Settings for drawing harmonised models: command-line options and their part of the report.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "ibr/htm.h"
#include "shared/cli/cli_fwd.h"

namespace ibr::app {

/// "htm", "vdtbm", "vdvbm": the methods' names in [H] §4.2.
const char* htmMethodName(HtmMethod method);

/// Declares --gamma and --weight-cut.
void declareHtmSettings(CLI::App& app, HtmSettings& settings);

/// Declares these, --method, --mesh and --smooth. `sourceMesh`: draws the mesh from before the optimisation.
void declareHtmPictureSettings(CLI::App& app, HtmSettings& settings, bool& sourceMesh);

/// Returns the effective settings, each under the name of its option.
nlohmann::ordered_json htmSettingsJson(const HtmSettings& settings, bool sourceMesh);

}  // namespace ibr::app
