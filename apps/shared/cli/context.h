// SPDX-License-Identifier: Apache-2.0
// What a program, or a command of it, gets: the common options, and where its words go. Results go to stdout, all else
// to stderr.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "ibr/log.h"

namespace ibr::app {

struct CommonOptions {
  const char* program = "ibr";  // before each message
  std::string json;             // file for the report, "-" for stdout, "" for none
  std::string device;
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = all cores
  bool quiet = false;
  bool verbose = false;
};

class Context {
 public:
  explicit Context(const CommonOptions& options) : options_(options) {}
  const CommonOptions& options() const { return options_; }

  /// A line of the result, for people. Dropped where stdout holds the JSON report. Throws Error{io}.
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) const {
    if (options_.json != "-") writeOut(fmt::format(format, std::forward<Args>(args)...));
  }

  /// The report for programs, complete; written where --json says. Throws Error{io}.
  void report(const std::string& json) const;

  /// Messages of the library and of the commands, to stderr.
  LogCallback log() const;
  template <class... Args>
  void say(LogLevel level, fmt::format_string<Args...> format, Args&&... args) const {
    write(level, fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  void write(LogLevel level, std::string_view message) const;
  static void writeOut(std::string_view text);

  CommonOptions options_;
};

/// Pushes what is still buffered to stdout. Throws Error{io} where it cannot be written: a full disk is a failure.
void flushResults();

/// "error: " in colour where stderr is a terminal and NO_COLOR is not set.
std::string_view levelName(LogLevel level);

}  // namespace ibr::app
