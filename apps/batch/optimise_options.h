// SPDX-License-Identifier: Apache-2.0
// Options of the ECC optimiser, and the optimiser with its device, for commands that change scenes.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "batch/context.h"
#include "ibr/optimise_scene.h"

namespace ibr::app {

/// All but the seed.
void declareAlignment(CLI::App& app, AlignmentOptions& options);

/// Words of --method and --definition, also of reports.
const char* wordOf(AlignmentMethod method);
const char* wordOf(EccDefinition definition);
AlignmentMethod parsedMethod(const std::string& option, const std::string& word);

/// align(), with a device of its own for the methods that need one. Copies share it. Throws Error{unsupported} where
/// there is none.
Aligner makeAligner(AlignmentMethod method, const Context& context);

}  // namespace ibr::app
