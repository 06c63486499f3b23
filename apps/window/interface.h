// SPDX-License-Identifier: Apache-2.0
// Dear ImGui in a window: its context and input. It is drawn by an InterfaceDrawer.
#pragma once

#include <deque>
#include <filesystem>
#include <string>

#include "window/window.h"

namespace ibr::app {

class Interface {
 public:
  /// `layout`: where panels' places are kept from one run to the next; empty: nowhere.
  Interface(Window& window, const std::filesystem::path& layout);
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  ~Interface();

  /// Everything is drawn so much larger than at 96 dpi, letters from their outlines. Between frames of ImGui. Says
  /// whether that is new: then a drawer that is there has the wrong letters.
  bool setScale(float scale);

  /// A frame of ImGui; the drawer's has begun.
  void beginFrame();

  /// Keys did more than one frame can show, such as down and up again: the next frame shows more of it.
  bool keysWait() const noexcept { return !keyChanges_.empty(); }

 private:
  void pressKeys();

  std::string layout_;
  Window& window_;
  std::deque<KeyChange> keyChanges_;  // that no frame has shown
  float scale_ = 0;
};

}  // namespace ibr::app
