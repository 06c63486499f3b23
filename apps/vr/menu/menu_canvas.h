// SPDX-License-Identifier: Apache-2.0
// Widgets of the menu's pages: rectangles, large buttons, shortened texts. Use within an ImGui frame.
#pragma once

#include <imgui.h>

#include <string>
#include <vector>

#include "vr/menu/menu.h"

namespace ibr::app {

/// Rectangle in pixels of the panel.
struct MenuRect {
  ImVec2 low, high;
  ImVec2 size() const noexcept { return {high.x - low.x, high.y - low.y}; }
  ImVec2 middle() const noexcept { return {0.5f * (low.x + high.x), 0.5f * (low.y + high.y)}; }
};

// Display-encoded colours.
inline constexpr ImU32 kMenuBackground = IM_COL32(20, 22, 26, 255), kMenuField = IM_COL32(32, 35, 41, 255),
                       kMenuButton = IM_COL32(52, 58, 66, 255), kMenuHovered = IM_COL32(78, 87, 98, 255),
                       kMenuSelected = IM_COL32(33, 131, 127, 255), kMenuPressed = IM_COL32(24, 96, 93, 255),
                       kMenuWarning = IM_COL32(178, 52, 46, 255), kMenuText = IM_COL32(240, 242, 244, 255),
                       kMenuDim = IM_COL32(160, 168, 178, 255), kMenuCurrentSpot = IM_COL32(253, 231, 37, 255);

enum class MenuButtonStyle { plain, marked, warning };
enum class MenuIcon { up, down, plus, minus };

struct MenuCanvas {
  float unit;  // pixels per unit; the panel is 600 units high
  std::vector<MenuItem>& items;
  ImDrawList& list;

  /// Converts units from the panel's upper left corner to pixels.
  MenuRect rect(float x, float y, float width, float height) const noexcept;

  /// Adds an invisible area. Returns true if it was pressed and released.
  bool area(const std::string& name, const MenuRect& at);
  bool button(const std::string& name, const std::string& label, const MenuRect& at,
              MenuButtonStyle style = MenuButtonStyle::plain);
  bool button(const std::string& name, MenuIcon sign, const MenuRect& at);
  /// Draws a row with a switch. Returns true if pressed.
  bool toggle(const std::string& name, const std::string& label, const MenuRect& at, bool on);

  /// Draws one line of text, shortened to fit; `align`: 0 left, 0.5 centred, 1 right.
  void text(const std::string& words, const MenuRect& at, ImU32 colour = kMenuText, float align = 0.5f);

 private:
  bool pressed(const std::string& name, const MenuRect& at, MenuButtonStyle style);
};

}  // namespace ibr::app
