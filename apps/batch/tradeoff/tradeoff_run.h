// SPDX-License-Identifier: Apache-2.0
// The run of `ibr tradeoff`: measures all settings, and writes the report and its figures.
#pragma once

#include "batch/tradeoff/tradeoff_inputs.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

/// Measures the settings and writes the report to the folder options.output, or only lists the settings. Returns
/// kExitComparison if options.check is set and a preset misses a guarantee that counts. Throws Error.
ExitCode runTradeoff(const TradeoffOptions& options, const Context& context);

}  // namespace ibr::app
