// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/context.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "base/file.h"
#include "shared/cli/progress.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

bool colourful() {
  static const bool answer = [] {
    const char* off = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) && !(off && *off) && terminal && std::string_view(terminal) != "dumb";
  }();
  return answer;
}

void checkOut(bool written) {
  check(written, ErrorCode::io, "standard output: cannot be written: {}", std::strerror(errno));
}

}  // namespace

std::string_view levelName(LogLevel level) {
  switch (level) {
    case LogLevel::error:
      return colourful() ? "\033[1;31merror:\033[0m " : "error: ";
    case LogLevel::warning:
      return colourful() ? "\033[1;33mwarning:\033[0m " : "warning: ";
    default:
      return "";
  }
}

void Context::write(LogLevel level, std::string_view message) const {
  if (level == LogLevel::debug && !options_.verbose) return;
  if (level < LogLevel::error && options_.quiet) return;
  writeBesideProgress(fmt::format("{}: {}{}\n", options_.program, levelName(level), message));
}

LogCallback Context::log() const {
  return [this](LogLevel level, std::string_view message) { write(level, message); };
}

void Context::report(const nlohmann::ordered_json& report) const {
  if (options_.json == "-")
    writeOut(jsonText(report));
  else if (!options_.json.empty())
    writeFile(options_.json, jsonText(report));
}

void Context::writeOut(std::string_view text) {
  checkOut(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void flushResults() {
  checkOut(std::fflush(stdout) == 0);
}

}  // namespace ibr::app
