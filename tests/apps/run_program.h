// SPDX-License-Identifier: Apache-2.0
// Runs a program, `ibr` for one, as a user does.
#pragma once

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

/// stdin is empty. Fails the test after two minutes.
Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A Vulkan device that `ibr` can use is there. Where IBR_REQUIRE_DEVICE is set, a missing one fails the test.
bool deviceIsThere();

}  // namespace ibr::test
