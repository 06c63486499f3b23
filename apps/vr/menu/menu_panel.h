// SPDX-License-Identifier: Apache-2.0
// The menu as a panel: Dear ImGui in a context of its own, whose mouse is a hand that points. No window, no device.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "vr/menu/menu.h"

struct ImGuiContext;

namespace ibr::app {

/// A hand's ray and button.
struct MenuPointer {
  std::optional<glm::dvec2> at;  // where it meets the panel: x to the right, y down, 0 to 1; none: beside it
  bool held = false;
};

class MenuPanel {
 public:
  /// Letters are kMenuLetters of its height; both sides at least 64 pixels, or Error{invalidInput}.
  MenuPanel(int width, int height);
  MenuPanel(const MenuPanel&) = delete;
  MenuPanel& operator=(const MenuPanel&) = delete;
  ~MenuPanel();

  int width() const noexcept { return width_; }
  int height() const noexcept { return height_; }

  /// The next frame, so many seconds after the one before. A press counts where it began on the panel; one that was
  /// held when the panel was opened does not.
  MenuWishes show(const MenuModel& model, const MenuPointer& pointer, double seconds);

  /// As if it were opened anew: the next frame is its first.
  void open();

  /// What was there in the last frame, in pixels.
  const std::vector<MenuItem>& items() const noexcept { return menu_.items(); }
  ImGuiContext* context() const noexcept { return context_; }

 private:
  void takePointer(const MenuPointer& pointer);

  int width_, height_;
  ImGuiContext* context_;
  Menu menu_;
  bool seenFree_ = false;  // the button, since the panel was opened
};

/// Makes a context of ImGui the current one while it lives.
class CurrentContext {
 public:
  explicit CurrentContext(ImGuiContext* context);
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;
  ~CurrentContext();

 private:
  ImGuiContext* before_;
};

}  // namespace ibr::app
