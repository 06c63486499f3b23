// SPDX-License-Identifier: Apache-2.0
// Exit codes of the programs, and the only conversion from errors to exit codes.
#pragma once

#include <array>
#include <functional>
#include <string_view>

#include "ibr/error.h"

namespace ibr::app {

/// Exit codes. Shells expect 130 of a program that Ctrl-C stopped.
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

struct ExitCodeMeaning {
  ExitCode code;
  const char* meaning;
};
inline constexpr std::array kExitCodes{
    ExitCodeMeaning{kExitOk, "success"},
    ExitCodeMeaning{
        kExitCommandLine,
        "the command line is wrong: a command or option is unknown, missing or malformed, or excludes another"},
    ExitCodeMeaning{kExitIo, "a file or folder cannot be read or written, or a program cannot be run"},
    ExitCodeMeaning{kExitInvalidInput,
                    "a file or a value is wrong, and the message names it; or the input does not fit the options"},
    ExitCodeMeaning{kExitRunTime, "memory is exhausted, the device was lost, or Vulkan failed"},
    ExitCodeMeaning{kExitUnsupported,
                    "this build, machine or device, or this kind of file, does not support the request"},
    ExitCodeMeaning{kExitComparison, "a comparison failed"},
    ExitCodeMeaning{kExitInterrupted, "stopped by Ctrl-C"},
};

ExitCode exitCodeOf(ErrorCode code);

/// Ends the program at once: neither waits for threads nor runs destructors. Writes what the C streams hold.
[[noreturn]] void exitWithoutWaiting(ExitCode code);

/// Writes "PROGRAM: error: WHAT" to stderr and returns `code`.
ExitCode printError(std::string_view program, std::string_view what, ExitCode code);

/// Returns the result of `body`; if `body` throws, reports the error with `printError` and returns its code.
ExitCode guarded(std::string_view program, const std::function<ExitCode()>& body) noexcept;

}  // namespace ibr::app
