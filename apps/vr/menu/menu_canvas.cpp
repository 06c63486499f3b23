// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/menu_canvas.h"

#include <algorithm>
#include <cmath>

namespace ibr::app {
namespace {

constexpr float kRounding = 9;  // units

ImU32 fill(MenuButtonStyle style) {
  if (ImGui::IsItemActive() && ImGui::IsItemHovered()) return kMenuPressed;
  if (style == MenuButtonStyle::marked) return kMenuSelected;
  if (style == MenuButtonStyle::warning) return kMenuWarning;
  return ImGui::IsItemHovered() ? kMenuHovered : kMenuButton;
}

std::string shortened(const std::string& words, float width) {
  const ImFont& font = *ImGui::GetFont();
  const float size = ImGui::GetFontSize();
  const auto upTo = [&](float most) {
    const char* rest = nullptr;
    font.CalcTextSizeA(size, most, 0, words.data(), words.data() + words.size(), &rest);
    return std::size_t(rest - words.data());
  };
  if (upTo(width) == words.size()) return words;
  return words.substr(0, upTo(width - ImGui::CalcTextSize("...").x)) + "...";
}

}  // namespace

MenuRect MenuCanvas::rect(float x, float y, float width, float height) const noexcept {
  return {{unit * x, unit * y}, {unit * (x + width), unit * (y + height)}};
}

bool MenuCanvas::area(const std::string& name, const MenuRect& at) {
  items.push_back({name, {at.low.x, at.low.y}, {at.high.x, at.high.y}});
  ImGui::SetCursorScreenPos(at.low);
  return ImGui::InvisibleButton(name.c_str(), at.size());
}

bool MenuCanvas::pressed(const std::string& name, const MenuRect& at, MenuButtonStyle style) {
  const bool result = area(name, at);
  list.AddRectFilled(at.low, at.high, fill(style), kRounding * unit);
  if (ImGui::IsItemHovered()) list.AddRect(at.low, at.high, kMenuText, kRounding * unit, 0, 2 * unit);
  return result;
}

bool MenuCanvas::button(const std::string& name, const std::string& label, const MenuRect& at, MenuButtonStyle style) {
  const bool result = pressed(name, at, style);
  text(label, at);
  return result;
}

bool MenuCanvas::button(const std::string& name, MenuIcon sign, const MenuRect& at) {
  const bool result = pressed(name, at, MenuButtonStyle::plain);
  const ImVec2 middle = at.middle();
  const float side = 14 * unit;
  const auto bar = [&](float x, float y) {
    list.AddRectFilled({middle.x - x, middle.y - y}, {middle.x + x, middle.y + y}, kMenuText, 2 * unit);
  };
  if (sign == MenuIcon::plus) bar(2.5f * unit, side);
  if (sign == MenuIcon::plus || sign == MenuIcon::minus) {
    bar(side, 2.5f * unit);
    return result;
  }
  const float down = sign == MenuIcon::up ? -0.6f * side : 0.6f * side;
  list.AddTriangleFilled({middle.x - side, middle.y - down}, {middle.x + side, middle.y - down},
                         {middle.x, middle.y + down}, kMenuText);
  return result;
}

bool MenuCanvas::toggle(const std::string& name, const std::string& label, const MenuRect& at, bool on) {
  const bool result = pressed(name, at, MenuButtonStyle::plain);
  const float gap = 16 * unit, width = 72 * unit, height = 36 * unit, radius = 0.5f * height;
  text(label, {{at.low.x + gap, at.low.y}, {at.high.x - width - 2 * gap, at.high.y}}, kMenuText, 0);
  const ImVec2 low{at.high.x - gap - width, at.middle().y - radius};
  const ImVec2 high{low.x + width, low.y + height};
  list.AddRectFilled(low, high, on ? kMenuSelected : kMenuBackground, radius);
  list.AddRect(low, high, on ? kMenuSelected : kMenuDim, radius, 0, 2 * unit);
  list.AddCircleFilled({on ? high.x - radius : low.x + radius, at.middle().y}, radius - 5 * unit,
                       on ? kMenuText : kMenuDim, 32);
  return result;
}

void MenuCanvas::text(const std::string& words, const MenuRect& at, ImU32 colour, float align) {
  const float margin = align == 0.5f ? 6 * unit : 0, room = at.size().x - 2 * margin;
  const std::string fitting = shortened(words, room);
  const char *begin = fitting.data(), *end = begin + fitting.size();
  const ImVec2 size = ImGui::CalcTextSize(begin, end);
  list.AddText({std::round(at.low.x + margin + align * (room - size.x)), std::round(at.middle().y - 0.5f * size.y)},
               colour, begin, end);
}

}  // namespace ibr::app
