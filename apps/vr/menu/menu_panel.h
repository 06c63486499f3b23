// SPDX-License-Identifier: Apache-2.0
// The menu as a panel: Dear ImGui in its own context, with a pointing hand as mouse. Needs no window and no device.
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
  std::optional<glm::dvec2> at;  // hit point on the panel: x to the right, y down, 0 to 1; nullopt: no hit
  bool held = false;
};

class MenuPanel {
 public:
  /// Font height is kMenuFontShare of `height`. Throws Error{invalidInput} if a side is below 64 pixels.
  MenuPanel(int width, int height);
  MenuPanel(const MenuPanel&) = delete;
  MenuPanel& operator=(const MenuPanel&) = delete;
  ~MenuPanel();

  int width() const noexcept { return width_; }
  int height() const noexcept { return height_; }

  /// Runs the next frame, `seconds` after the previous one. A press counts where it began on the panel. A button
  /// already held when the panel was opened must be released first.
  MenuRequests show(const MenuModel& model, const MenuPointer& pointer, double seconds);

  /// Opens the panel: resets the menu; the next frame is its first.
  void open();

  /// Items of the last frame, in pixels.
  const std::vector<MenuItem>& items() const noexcept { return menu_.items(); }
  ImGuiContext* context() const noexcept { return context_; }

 private:
  void setPointer(const MenuPointer& pointer);

  int width_, height_;
  ImGuiContext* context_;
  Menu menu_;
  bool releasedSinceOpen_ = false;  // the button was seen released since the panel was opened
};

/// Makes an ImGui context current for the lifetime of this object.
class CurrentContext {
 public:
  explicit CurrentContext(ImGuiContext* context);
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;
  ~CurrentContext();

 private:
  ImGuiContext* previous_;
};

}  // namespace ibr::app
