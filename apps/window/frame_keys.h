// SPDX-License-Identifier: Apache-2.0
// Keys that are down in each frame. On a slow device most keys go down and up between two frames and would be missed.
// Each frame therefore takes the changes in order, at most one per key.
#pragma once

#include <deque>
#include <set>
#include <span>

namespace ibr::app {

/// A key that went down or up; GLFW key code, by position on a US keyboard.
struct KeyChange {
  int key = 0;
  bool down = false;
};

class FrameKeys {
 public:
  /// Begins a frame: changes since the previous frame, in order.
  void beginFrame(std::span<const KeyChange> changes);

  bool isDown(int key) const { return down_.contains(key); }

  /// Returns true if changes are waiting for the next frame.
  bool hasPending() const noexcept { return !waiting_.empty(); }

 private:
  std::deque<KeyChange> waiting_;  // not yet applied to a frame
  std::set<int> down_;
};

}  // namespace ibr::app
