// SPDX-License-Identifier: Apache-2.0
// A sub-command of `ibr`: help texts, options and action.
#pragma once

#include <functional>
#include <span>

#include "shared/cli/cli_fwd.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct Command {
  const char* name;
  const char* summary;         // one line
  const char* examples;        // one command a line
  const char* details;         // paragraphs for --help; may be empty
  const char* afterInterrupt;  // files left and how to resume, in lower case without full stop; may be empty
  /// Options that --help shows, separated by spaces; empty: all. --help-all shows all.
  const char* mainOptions = "";
  /// Declares options and returns the action to run after parsing. The action throws Error.
  std::function<ExitCode(const Context&)> (*declare)(CLI::App&);
  /// Sub-commands of a group, one of which must follow its name. A group declares no options.
  std::span<const Command* const> commands = {};
};

extern const Command kBuildCommand, kRenderCommand, kViewCommand, kInfoCommand, kDoctorCommand, kEvalCommand,
    kWalkCommand, kCompareCommand, kValidateCommand, kRefineCommand, kOptimiseCommand, kSplitCommand, kHtmCommand,
    kBenchCommand, kTradeoffCommand;

}  // namespace ibr::app
