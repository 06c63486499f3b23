// SPDX-License-Identifier: Apache-2.0
// How long the last frames took, for people to look at.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "gpu/draw/scope.h"

namespace ibr::app {

struct FrameTimes {
  std::size_t frame = 0;                                      // its number; 0: none
  float sinceLast = std::numeric_limits<float>::quiet_NaN();  // ms; not a number after a rest
  std::vector<std::pair<std::size_t, float>> passes;          // ms on the device; index into names
};

class FrameHistory {
 public:
  static constexpr std::size_t kLength = 120;

  void add(std::size_t frame, float sinceLast) { slot(frame) = {frame, sinceLast, {}}; }

  /// The device's times of a frame come later.
  void addDevice(std::size_t frame, const std::vector<ScopeTime>& scopes) {
    if (of(frame).frame != frame) return;
    for (const ScopeTime& scope : scopes)
      if (scope.depth == 0) slot(frame).passes.emplace_back(indexOf(scope.name), float(scope.milliseconds));
  }

  /// Of a frame that is one of the last, or that is not there (its number is another).
  const FrameTimes& of(std::size_t frame) const { return ring_[frame % kLength]; }
  /// Passes that were seen so far, each where it was seen first.
  const std::vector<std::string>& names() const { return names_; }
  std::size_t indexOf(const std::string& name) {
    const auto found = std::ranges::find(names_, name);
    if (found != names_.end()) return std::size_t(found - names_.begin());
    names_.push_back(name);
    return names_.size() - 1;
  }

 private:
  FrameTimes& slot(std::size_t frame) { return ring_[frame % kLength]; }
  std::array<FrameTimes, kLength> ring_;
  std::vector<std::string> names_;
};

}  // namespace ibr::app
