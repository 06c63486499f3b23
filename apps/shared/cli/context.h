// SPDX-License-Identifier: Apache-2.0
// Context of a program or command: common options and output. Results go to stdout, all messages to
// stderr.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "ibr/log.h"

namespace ibr::app {

struct CommonOptions {
  const char* program = "ibr";  // prefix of each message
  std::string json;             // report file; "-": stdout; "": none
  std::string device;
  std::uint64_t seed = 1;
  int threads = 0;  // 0: all cores
  bool quiet = false;
  bool verbose = false;
};

class Context {
 public:
  explicit Context(const CommonOptions& options) : options_(options) {}
  const CommonOptions& options() const { return options_; }

  /// Prints a result line for people. Dropped with -q, and if the JSON report goes to stdout. Throws Error{io}.
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) const {
    if (options_.json != "-" && !options_.quiet) writeOut(fmt::format(format, std::forward<Args>(args)...));
  }

  /// Writes the complete report, for programs, to the destination of --json. Throws Error{io}.
  void report(const nlohmann::ordered_json& report) const;

  /// Log for messages of the library and of the commands, to stderr.
  LogCallback log() const;
  template <class... Args>
  void logMessage(LogLevel level, fmt::format_string<Args...> format, Args&&... args) const {
    write(level, fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  void write(LogLevel level, std::string_view message) const;
  static void writeOut(std::string_view text);

  CommonOptions options_;
};

/// Flushes stdout. Throws Error{io} if the buffered output cannot be written, such as on a full disk.
void flushResults();

/// "error: " and the like, in colour if stderr is a terminal and NO_COLOR is not set.
std::string_view levelName(LogLevel level);

}  // namespace ibr::app
