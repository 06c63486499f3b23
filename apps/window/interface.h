// SPDX-License-Identifier: Apache-2.0
// Dear ImGui in a window: its context and input. It is drawn by an InterfaceDrawer.
#pragma once

#include <filesystem>
#include <string>

#include "window/window.h"

namespace ibr::app {

class Interface {
 public:
  /// `layout`: where panels' places are kept from one run to the next; empty: nowhere.
  Interface(const Window& window, const std::filesystem::path& layout);
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  ~Interface();

  /// Everything is drawn so much larger than at 96 dpi, letters from their outlines. Between frames of ImGui. Says
  /// whether that is new: then a drawer that is there has the wrong letters.
  bool setScale(float scale);

  /// A frame of ImGui; the drawer's has begun.
  void beginFrame();

 private:
  std::string layout_;
  const Window& window_;
  float scale_ = 0;
};

}  // namespace ibr::app
