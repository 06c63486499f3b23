// SPDX-License-Identifier: Apache-2.0
// What shall go wrong between a program and its OpenXR runtime, from words such as
// "session-loss@40,formats=97:91,not-rendered@20-30,no-stage": name[=value][@first[-last]], first and last being
// frames.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ibr::test {

struct Fault {
  std::string name, value;
  int first = 0, last = std::numeric_limits<int>::max();  // without frames: always
  bool spent = false;                                     // one that happens once has happened
};

class Faults {
 public:
  Faults() = default;
  /// Throws std::invalid_argument for a name that there is not and for what is not written as above.
  explicit Faults(const std::string& words);

  /// Frames are counted from 1 by xrWaitFrame, through all sessions and instances of the process; 0 is before.
  void nextFrame() { ++frame_; }
  int frame() const { return frame_; }

  /// The value of a fault that lasts, while it does.
  std::optional<std::string> active(const std::string& name) const;
  /// The value of a fault that happens once, the first time that this is asked at its frame or later.
  std::optional<std::string> due(const std::string& name);

 private:
  int frame_ = 0;
  std::vector<Fault> faults_;
};

}  // namespace ibr::test
