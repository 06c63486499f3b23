// SPDX-License-Identifier: Apache-2.0
// Progress on stderr: a bar on a terminal; elsewhere a line at each stage, and at most one every 5 s. A process has at
// most one progress line at a time.
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
  ~ProgressLine();  // removes the bar
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Returns false after Ctrl-C was pressed.
  bool show(const Progress& progress);

  /// Callback for functions of the library; *this must outlive the callback.
  ProgressCallback callback() {
    return [this](const Progress& progress) { return show(progress); };
  }

  /// Seconds by stage so far, in the order of the stages' first calls.
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
  std::size_t firstDone_ = 0;  // of the current stage: cached results of an earlier run do not enter the remaining time
  int tenths_ = -1;
};

/// Formats a duration: "7 s", "3 min 05 s", "2 h 10 min"
std::string durationText(double seconds);

/// Writes a whole line to stderr, above the bar if there is one.
void writeBesideProgress(std::string_view line);

}  // namespace ibr::app
