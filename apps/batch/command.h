// SPDX-License-Identifier: Apache-2.0
// A sub-command of `ibr`: its words, its options and what it does.
#pragma once

#include <functional>
#include <span>

#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace CLI {
class App;
}

namespace ibr::app {

struct Command {
  const char* name;
  const char* summary;   // one line
  const char* examples;  // a command a line
  const char* details;   // paragraphs for --help; may be empty
  const char* afterInterrupt;
  /// Declares options and gives what runs after they were parsed. Throws Error.
  std::function<ExitCode(const Context&)> (*declare)(CLI::App&);
  /// A group instead: it declares nothing and one of these must follow its name.
  std::span<const Command* const> commands = {};
};

extern const Command kBuildCommand, kInfoCommand, kValidateCommand, kRenderCommand, kEvalCommand, kCompareCommand,
    kDeviceCommand, kBenchCommand, kAccuracyCommand, kSynthCommand, kWalkCommand, kSplitCommand, kOptimiseCommand,
    kSweepCommand, kHtmCommand, kDoctorCommand, kRefineCommand, kTradeoffCommand;

}  // namespace ibr::app
