// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/exit_code.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>

#include "shared/cli/context.h"

namespace ibr::app {

ExitCode exitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::io:
      return kExitIo;
    case ErrorCode::invalidInput:
      return kExitInvalidInput;
    case ErrorCode::unsupported:
      return kExitUnsupported;
    case ErrorCode::cancelled:
      return kExitInterrupted;
    case ErrorCode::outOfMemory:
    case ErrorCode::deviceLost:
    case ErrorCode::vulkan:
      return kExitRunTime;
  }
  return kExitRunTime;
}

void exitWithoutWaiting(ExitCode code) {
  std::fflush(nullptr);
  std::_Exit(int(code));
}

ExitCode printError(std::string_view program, std::string_view what, ExitCode code) {
  std::fputs(fmt::format("{}: {}{}\n", program, levelName(LogLevel::error), what).c_str(), stderr);
  return code;
}

ExitCode guarded(std::string_view program, const std::function<ExitCode()>& body) noexcept {
  try {
    return body();
  } catch (const Error& e) {
    return printError(program, e.what(), exitCodeOf(e.code()));
  } catch (const std::bad_alloc&) {
    return printError(program, "out of memory", kExitRunTime);
  } catch (const std::filesystem::filesystem_error& e) {
    return printError(program, e.what(), kExitIo);
  } catch (const std::exception& e) {
    return printError(program, e.what(), kExitRunTime);
  }
}

}  // namespace ibr::app
