// SPDX-License-Identifier: Apache-2.0
// Writes a line of JSON for each frame, and a summary. The file is complete after every line.
//
//   {"frame":1,"intervalMs":13.9,"processorMs":3.1,"deviceMs":7.9,"level":0,"cells":12,"missed":false}
//   {"frame":812,"decision":"frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"}
//   {"summary":{"frames":900,"intervalMs":{"p50":…,"p95":…,"p99":…},…,"missed":3}}
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace ibr::app {

struct FrameLogEntry {
  std::uint64_t frame = 0;  // counted from 1
  double intervalMs = 0;    // between the display times of the previous frame and this one; 0: first, or after a pause
  double processorMs = 0;   // CPU time from the start of the frame to its submission, without waits
  double deviceMs = 0;      // GPU time; 0: unknown
  std::size_t level = 0;    // of the governor
  std::size_t cells = 0;    // drawn
  bool missed = false;      // the previous frame was shown for longer than one display period
};

class FrameLog {
 public:
  /// An empty path: no file. Throws Error{io} if the file cannot be written.
  explicit FrameLog(const std::filesystem::path& file);

  void add(const FrameLogEntry& times);
  void add(std::uint64_t frame, const std::string& decision);
  /// Writes the summary line and returns its contents.
  nlohmann::ordered_json finish();
  /// Throws Error{io} if a line could not be written.
  void check() const;

 private:
  void write(const nlohmann::ordered_json& line);

  std::filesystem::path path_;
  std::ofstream file_;
  std::vector<double> intervals_, processor_, device_;
  std::uint64_t frames_ = 0, missed_ = 0, decisions_ = 0;
};

}  // namespace ibr::app
