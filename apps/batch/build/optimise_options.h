// SPDX-License-Identifier: Apache-2.0
// Options of the ECC optimiser, and the optimiser with its device, for commands that change scenes.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ibr/author/optimise_scene.h"
#include "shared/cli/cli_fwd.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// Declares all options of the alignment but the seed.
void declareAlignment(CLI::App& app, AlignmentOptions& options);

/// Limits of the options' values.
inline constexpr std::pair kInstancesLimits{2, 256};
inline constexpr std::pair kRadiusLimits{0.01, 64.0};
inline constexpr std::pair kDecayLimits{0.01, 1.0};
inline constexpr std::pair kThresholdLimits{0.0, 1.0};
inline constexpr std::pair kRigidityLimits{0.0, 10000.0};

/// Declares --cells-only.
void declareCellsOnly(CLI::App& app, std::vector<std::size_t>& cells, const char* description);

/// Words of --method and --definition, also in reports.
const char* optionValue(AlignmentMethod method);
const char* optionValue(EccDefinition definition);
AlignmentMethod parsedMethod(const std::string& option, const std::string& word);

/// Returns align(), with its own device for the methods that need one; copies share the device. Throws
/// Error{unsupported} if there is no device.
Aligner makeAligner(AlignmentMethod method, const Context& context);

}  // namespace ibr::app
