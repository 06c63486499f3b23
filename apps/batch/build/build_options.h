// SPDX-License-Identifier: Apache-2.0
// Options of builds, declared once for all commands that build scenes, so that all of them build the same.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author/build.h"
#include "shared/cli/context.h"
#include "shared/cli/options.h"

namespace ibr::app {

struct BuildChoices {
  BuildOptions build;  // photographs, model, output, seed and threads are set by buildOptionsOf
  std::string model, excludeFrom;
  std::string optimise;  // method of the optimiser; empty: cells are not optimised
};

/// Declares the options for input beside the photographs: --model (or --transforms, --panoramas), and --masks.
void declareInputOptions(CLI::App& app, BuildChoices& choices);

/// Declares all options, the input options included, but not the photographs' and scene's folders. Returns them.
std::vector<Option> declareBuildOptions(CLI::App& app, BuildChoices& choices);

/// Returns complete options but for the output. Looks for a model near the photographs if no poses are given; without a
/// model the build runs COLMAP. Throws Error.
BuildOptions buildOptionsOf(const BuildChoices& choices, const std::filesystem::path& photographs,
                            const Context& context);

}  // namespace ibr::app
