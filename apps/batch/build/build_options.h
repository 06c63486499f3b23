// SPDX-License-Identifier: Apache-2.0
// Options of building, for all commands that build scenes: declared once, so that they build the same.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct BuildChoices {
  BuildOptions build;  // photographs, model, transforms, panoramas, output, seed and threads are not set yet
  std::string model, transforms, panoramas, excludeFrom;
  std::string optimise;  // the optimiser's method; empty: cells stay as they are matched
};

/// What lies beside the photographs: --model, --transforms or --panoramas, and --masks.
void declareInputOptions(CLI::App& app, BuildChoices& choices);

/// All (those, too) but the photographs' and the scene's folder. Gives what it declared.
std::vector<CLI::Option*> declareBuildOptions(CLI::App& app, BuildChoices& choices);

/// Complete but for the output. Looks for a model near the photographs where no poses are given; where there is none,
/// building runs COLMAP. Throws Error.
BuildOptions buildOptionsOf(const BuildChoices& choices, const std::filesystem::path& photographs,
                            const Context& context);

}  // namespace ibr::app
