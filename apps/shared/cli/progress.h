// SPDX-License-Identifier: Apache-2.0
// Progress on stderr: a bar on a terminal, a line each 10 % elsewhere. One at a time in a process.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/cli/context.h"

namespace ibr::app {

class ProgressLine {
 public:
  explicit ProgressLine(const Context& context);
  ~ProgressLine();  // takes the bar away
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// False once Ctrl-C was pressed.
  bool show(const Progress& progress);

  /// For calls of the library; *this must outlive it.
  ProgressCallback callback() {
    return [this](const Progress& progress) { return show(progress); };
  }

  /// Seconds by stage so far, in the order in which stages were first seen.
  std::vector<std::pair<std::string, double>> stageSeconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  void enter(std::string_view stage);
  void draw(const Progress& progress);

  const char* program_;
  bool visible_, terminal_;
  std::vector<std::pair<std::string, double>> stages_;
  std::size_t current_ = 0;
  Clock::time_point entered_, drawn_;
  std::size_t firstDone_ = 0;  // of the current stage: what an earlier run had left does not count for the rest time
  int tenths_ = -1;
};

/// "7 s", "3 min 05 s", "2 h 10 min"
std::string durationText(double seconds);

/// Writes a whole line to stderr, above the bar if there is one.
void writeBesideProgress(std::string_view line);

}  // namespace ibr::app
