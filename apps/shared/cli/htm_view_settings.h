// SPDX-License-Identifier: Apache-2.0
// How harmonised models are drawn: options of a command and a part of its report.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ibr/htm.h"

namespace ibr::app {

/// "htm", "vdtbm", "vdvbm": the methods as [H] §4.2 names them.
const char* htmMethodName(HtmMethod method);

/// --gamma and --weight-cut.
void declareHtmSettings(CLI::App& app, HtmSettings& settings);

/// These, --method, --mesh and --smooth. `onSource`: the mesh from before it was optimised.
void declareHtmPictureSettings(CLI::App& app, HtmSettings& settings, bool& onSource);

/// The effective settings, each under the name of its option.
nlohmann::ordered_json htmSettingsJson(const HtmSettings& settings, bool onSource);

}  // namespace ibr::app
