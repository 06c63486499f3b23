// SPDX-License-Identifier: Apache-2.0
// Options of the ECC optimiser, and the optimiser with its device, for commands that change scenes.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ibr/optimise_scene.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// All but the seed.
void declareAlignment(CLI::App& app, AlignmentOptions& options);

/// What the options take.
inline constexpr std::pair kInstancesLimits{2, 256};
inline constexpr std::pair kRadiusLimits{0.01, 64.0};
inline constexpr std::pair kDecayLimits{0.01, 1.0};
inline constexpr std::pair kThresholdLimits{0.0, 1.0};
inline constexpr std::pair kRigidityLimits{0.0, 10000.0};

/// --cells-only
void declareCellsOnly(CLI::App& app, std::vector<std::size_t>& cells, const char* description);

/// Words of --method and --definition, also of reports.
const char* wordOf(AlignmentMethod method);
const char* wordOf(EccDefinition definition);
AlignmentMethod parsedMethod(const std::string& option, const std::string& word);

/// align(), with a device of its own for the methods that need one. Copies share it. Throws Error{unsupported} where
/// there is none.
Aligner makeAligner(AlignmentMethod method, const Context& context);

}  // namespace ibr::app
