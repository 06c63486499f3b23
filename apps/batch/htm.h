// SPDX-License-Identifier: Apache-2.0
// The commands of `ibr htm`, and what they share.
#pragma once

#include <CLI/CLI.hpp>

#include "batch/command.h"
#include "ibr/htm.h"

namespace ibr::app {

extern const Command kHtmBuildCommand, kHtmSequenceCommand, kHtmRenderCommand, kHtmEvalCommand;

/// "htm", "vdtbm", "vdvbm": the methods as [H] §4.2 names them.
const char* htmMethodName(HtmMethod method);

/// --gamma and --weight-cut.
void declareHtmSettings(CLI::App& app, HtmSettings& settings);

}  // namespace ibr::app
