// SPDX-License-Identifier: Apache-2.0
// Runs a program, by default `ibr`, as a user does.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace ibr::test {

struct Outcome {
  int code = -1;  // exit code, or 128 plus the signal that ended the program
  std::string out, err;
};

struct RunOptions {
  std::string program;                   // path of the executable; empty: `ibr`
  std::vector<std::string> environment;  // NAME=value
  std::string out;                       // file that receives stdout instead of `Outcome::out`
  bool terminal = false;                 // stderr is a terminal
  /// Called with stderr so far. Once the function returns true, the program gets SIGINT.
  std::function<bool(const std::string& err)> interruptWhen;
};

/// A running program, for tests that act while the program runs.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});
  /// Kills the program if it still runs.
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Waits at most 0.1 s for output. Returns false after the program has closed stdout and stderr.
  bool read();
  /// Waits until `come` returns true, calling it repeatedly. Returns false if the program ends first.
  bool runsUntil(const std::function<bool()>& come);
  /// Sends SIGINT.
  void interrupt();
  /// Output so far.
  const std::string& out() const { return outcome_.out; }
  const std::string& err() const { return outcome_.err; }
  /// Waits for the program's end. Like all waits of this class, fails the test two minutes after the start.
  Outcome finish();

 private:
  void checkTime();

  int child_ = -1, out_ = -1, err_ = -1;
  std::chrono::steady_clock::time_point deadline_;
  Outcome outcome_;
};

/// Runs a program with empty stdin. Fails the test after two minutes.
Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});
/// Runs `ibr-lab` in the same way.
Outcome runLab(const std::vector<std::string>& arguments, RunOptions options = {});

/// Returns whether `ibr` can use a Vulkan device. If IBR_REQUIRE_DEVICE is set, a missing device fails the test.
bool deviceIsThere();

}  // namespace ibr::test
