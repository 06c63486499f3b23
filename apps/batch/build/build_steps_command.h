// SPDX-License-Identifier: Apache-2.0
// `ibr build --steps` and `--step`: a build that many processes share (ibr/author/build_steps.h).
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ibr/author/build_steps.h"
#include "shared/cli/cli_fwd.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct StepChoices {
  bool list = false;  // --steps
  std::string step;   // --step; empty: the whole build
  int photographs = kPhotographsPerStep;
  std::vector<std::string> arguments;  // of the command, without these options, threads, memory and output
};

void declareStepOptions(CLI::App& app, StepChoices& choices);

/// Reads the arguments, after parsing.
void noteArguments(const CLI::App& app, StepChoices& choices);

/// Prints the list of steps as JSON, to --json or to stdout. Throws Error.
ExitCode listSteps(const StepChoices& choices, const BuildOptions& options, const Context& context);

/// Runs a step other than kSceneStep. Throws Error.
ExitCode runStep(const StepChoices& choices, const BuildOptions& options, const Context& context);

/// Resources that this process has used so far, for the report of a step.
nlohmann::ordered_json stepUsage(const std::string& step);

}  // namespace ibr::app
