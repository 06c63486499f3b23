// SPDX-License-Identifier: Apache-2.0
// What the programs return: the one place where errors become exit codes.
#pragma once

#include <functional>
#include <string_view>

#include "ibr/error.h"

namespace ibr::app {

/// Exit codes (ARCHITECTURE §7). 130 is what shells expect of a program that Ctrl-C stopped.
enum ExitCode : int {
  kExitOk = 0,
  kExitCommandLine = 1,
  kExitIo = 2,
  kExitInvalidInput = 3,
  kExitRunTime = 4,
  kExitUnsupported = 5,
  kExitComparison = 6,
  kExitInterrupted = 130,
};

ExitCode exitCodeOf(ErrorCode code);

/// Writes "PROGRAM: error: WHAT" to stderr and gives `code` back.
ExitCode complain(std::string_view program, std::string_view what, ExitCode code);

/// What `body` gives; where it throws, the error's code after `complain`.
ExitCode guarded(std::string_view program, const std::function<ExitCode()>& body) noexcept;

}  // namespace ibr::app
