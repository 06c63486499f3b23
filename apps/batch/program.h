// SPDX-License-Identifier: Apache-2.0
// A program with sub-commands: `ibr`, `ibr-lab`.
#pragma once

#include <span>

#include "batch/command.h"

namespace ibr::app {

struct Program {
  const char* name;
  const char* help;  // examples, then a sentence
  std::span<const Command* const> commands;
};

/// Parses the command line and runs the command. Returns the exit code; errors are printed.
int runProgram(const Program& program, int argc, char** argv);

}  // namespace ibr::app
