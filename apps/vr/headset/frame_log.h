// SPDX-License-Identifier: Apache-2.0
// What became of each frame, as lines of JSON in a file that is whole at any time, and what they come to.
//
//   {"frame":1,"intervalMs":13.9,"processorMs":3.1,"deviceMs":7.9,"level":0,"cells":12,"missed":false}
//   {"frame":812,"decision":"frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"}
//   {"summary":{"frames":900,"intervalMs":{"p50":…,"p95":…,"p99":…},…,"missed":3}}
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ibr::app {

struct FrameTimes {
  std::uint64_t frame = 0;  // from 1
  double intervalMs = 0;    // between the times at which it and the one before are seen; 0: the first
  double processorMs = 0;   // of work from when it could be begun until it was handed over: waits do not count
  double deviceMs = 0;      // 0: not known
  std::size_t level = 0;    // of the governor
  std::size_t cells = 0;    // that were drawn
  bool missed = false;      // the one before was shown for longer than a frame
};

class FrameLog {
 public:
  /// An empty path: no file. Throws Error{io} where it cannot be written.
  explicit FrameLog(const std::filesystem::path& file);

  void add(const FrameTimes& times);
  void add(std::uint64_t frame, const std::string& decision);
  /// Writes the last line, and gives what stands there.
  nlohmann::ordered_json finish();
  /// Throws Error{io} where not all could be written.
  void check() const;

 private:
  void write(const nlohmann::ordered_json& line);

  std::filesystem::path path_;
  std::ofstream file_;
  std::vector<double> intervals_, processor_, device_;
  std::uint64_t frames_ = 0, missed_ = 0, decisions_ = 0;
};

}  // namespace ibr::app
