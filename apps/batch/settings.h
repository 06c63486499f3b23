// SPDX-License-Identifier: Apache-2.0
// Render settings as options of a command and as a part of its report.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ibr/renderer.h"

namespace ibr::app {

/// All of them.
void declareSettings(CLI::App& app, RenderSettings& settings);

/// Without --cells and --order, for a command that tries several of each.
void declarePictureSettings(CLI::App& app, RenderSettings& settings);

/// The effective settings, each under the name of its option.
nlohmann::ordered_json settingsJson(const RenderSettings& settings);

}  // namespace ibr::app
