// SPDX-License-Identifier: Apache-2.0
// Faults between a program and its OpenXR runtime, parsed from words such as
// "session-loss@40,formats=97:91,not-rendered@20-30,no-stage". Syntax: name[=value][@first[-last]], where first and
// last are frame numbers.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ibr::test {

struct Fault {
  std::string name, value;
  int first = 0, last = std::numeric_limits<int>::max();  // without frames: always
  bool spent = false;                                     // a one-time fault has happened
};

class Faults {
 public:
  Faults() = default;
  /// Throws std::invalid_argument for an unknown name or a syntax error.
  explicit Faults(const std::string& words);

  /// xrWaitFrame counts frames from 1, across all sessions and instances of the process; 0 is before the first frame.
  void nextFrame() { ++frame_; }
  int frame() const { return frame_; }

  /// Returns the value of a persistent fault while the fault is active.
  std::optional<std::string> active(const std::string& name) const;
  /// Returns the value of a one-time fault at the first call at or after its frame.
  std::optional<std::string> due(const std::string& name);

 private:
  int frame_ = 0;
  std::vector<Fault> faults_;
};

}  // namespace ibr::test
