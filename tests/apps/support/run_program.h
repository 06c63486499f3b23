// SPDX-License-Identifier: Apache-2.0
// Runs a program, `ibr` for one, as a user does.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace ibr::test {

struct Outcome {
  int code = -1;  // exit code, or 128 + the signal that ended it
  std::string out, err;
};

struct RunOptions {
  std::string program;                   // file; empty: that of `ibr`
  std::vector<std::string> environment;  // NAME=value
  std::string out;                       // file that stdout goes to instead
  bool terminal = false;                 // stderr is a terminal
  /// Called with what stderr has so far; once it answers true, the program gets SIGINT.
  std::function<bool(const std::string& err)> interruptWhen;
};

/// A program while it runs, for who has something to do meanwhile.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});
  /// Kills it where it still runs.
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Waits for what it says, a tenth of a second at most; false once it has closed stdout and stderr.
  bool read();
  /// Waits until `come` answers true, which is asked again and again; false where the program ends before.
  bool runsUntil(const std::function<bool()>& come);
  /// Sends SIGINT.
  void interrupt();
  /// What it has said so far.
  const std::string& out() const { return outcome_.out; }
  const std::string& err() const { return outcome_.err; }
  /// Waits for its end. As all that waits here, it fails the test two minutes after the start.
  Outcome finish();

 private:
  void checkTime();

  int child_ = -1, out_ = -1, err_ = -1;
  std::chrono::steady_clock::time_point deadline_;
  Outcome outcome_;
};

/// stdin is empty. Fails the test after two minutes.
Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A Vulkan device that `ibr` can use is there. Where IBR_REQUIRE_DEVICE is set, a missing one fails the test.
bool deviceIsThere();

}  // namespace ibr::test
