// SPDX-License-Identifier: Apache-2.0
// Writes a line of JSON for each frame, and a summary. A thread of its own writes the lines soon after they were added,
// so that frames do not wait for the disk.
//
//   {"frame":1,"intervalMs":13.9,"processorMs":3.1,"deviceMs":7.9,"level":0,"cells":12,"missed":false}
//   {"frame":812,"decision":"frame 812: 10.4 ms of 11.1 ms: cells 12 → 8"}
//   {"summary":{"frames":900,"intervalMs":{"p50":…,"p95":…,"p99":…},…,"missed":3}}
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
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

/// Threading: one thread uses the object.
class FrameLog {
 public:
  /// An empty path: no file. Throws Error{io} if the file cannot be written.
  explicit FrameLog(const std::filesystem::path& file);
  FrameLog(const FrameLog&) = delete;
  FrameLog& operator=(const FrameLog&) = delete;
  ~FrameLog();  // writes all lines

  /// Does not wait for the file. Keeps three numbers of each frame for the summary, and allocates memory for them from
  /// time to time.
  void add(const FrameLogEntry& times);
  void add(std::uint64_t frame, const std::string& decision);
  /// Writes all lines and the summary, and returns the summary's contents. Nothing may be added afterwards.
  nlohmann::ordered_json finish();
  /// Throws Error{io} if a line could not be written. Call after finish().
  void check() const;

 private:
  struct Line {
    FrameLogEntry times;
    std::string decision;  // empty: a line of times
  };

  void add(Line line);
  void run();
  void writeLines();
  void write(const nlohmann::ordered_json& line);

  std::filesystem::path path_;
  std::ofstream file_;  // of the thread until it has ended
  std::vector<double> intervals_, processor_, device_;
  std::uint64_t frames_ = 0, missed_ = 0, decisions_ = 0;
  std::mutex mutex_;  // guards lines_ and ending_
  std::condition_variable changed_;
  std::vector<Line> lines_;  // not yet written
  bool ending_ = false;
  std::thread thread_;  // last: uses members above; none without a file
};

}  // namespace ibr::app
