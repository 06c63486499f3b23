// SPDX-License-Identifier: Apache-2.0
// Durations of the last frames, for the interface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "ibr/scope_timer.h"

namespace ibr::app {

struct FrameTimes {
  std::size_t frame = 0;                                      // frame number; 0: none
  float sinceLast = std::numeric_limits<float>::quiet_NaN();  // ms; NaN after a pause in drawing
  std::vector<std::pair<std::size_t, float>> passes;          // ms on the device; first: index into names()
};

class FrameHistory {
 public:
  static constexpr std::size_t kLength = 120;

  void add(std::size_t frame, float sinceLast) { slot(frame) = {frame, sinceLast, {}}; }

  /// Adds the device times of a frame, which arrive some frames later.
  void addDevice(std::size_t frame, const std::vector<ScopeTime>& scopes) {
    if (of(frame).frame != frame) return;
    for (const ScopeTime& scope : scopes)
      if (scope.depth == 0) slot(frame).passes.emplace_back(indexOf(scope.name), float(scope.milliseconds));
  }

  /// Returns the entry of a frame. If the frame is not among the last kLength, FrameTimes::frame differs from `frame`.
  const FrameTimes& of(std::size_t frame) const { return ring_[frame % kLength]; }
  /// Names of the passes so far, in order of first appearance.
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
