// SPDX-License-Identifier: Apache-2.0
// Dear ImGui in a window: its context and input. An InterfaceDrawer draws it.
#pragma once

#include <filesystem>
#include <string>

#include "window/frame_keys.h"
#include "window/window.h"

namespace ibr::app {

class Interface {
 public:
  /// `layout`: file that stores the positions of panels between runs; empty: none.
  Interface(Window& window, const std::filesystem::path& layout);
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  ~Interface();

  /// Sets the size of fonts and panels relative to 96 dpi. Call between ImGui frames. Returns true if the scale
  /// changed: the font texture of an existing InterfaceDrawer is then outdated.
  bool setScale(float scale);

  /// Begins an ImGui frame. Call InterfaceDrawer::beginFrame() first.
  void beginFrame();

  /// Returns the keys that are down in this frame.
  const FrameKeys& keys() const noexcept { return keys_; }
  /// Returns true if key changes are waiting for the next frame.
  bool hasPendingKeys() const noexcept;

 private:
  std::string layout_;
  Window& window_;
  FrameKeys keys_;
  float scale_ = 0;
};

}  // namespace ibr::app
