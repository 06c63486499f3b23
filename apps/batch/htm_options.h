// SPDX-License-Identifier: Apache-2.0
// Options of harmonising, for all commands that build harmonised models.
#pragma once

#include <CLI/CLI.hpp>

#include "batch/context.h"
#include "ibr/htm_author.h"

namespace ibr::app {

void declareHtmOptions(CLI::App& app, HtmOptions& options);

/// The same with the threads of the common options.
HtmOptions withThreads(HtmOptions options, const Context& context);

}  // namespace ibr::app
