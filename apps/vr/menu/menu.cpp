// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/menu.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vr/menu/menu_sheet.h"

namespace ibr::app {
namespace {

// Layout in units; the panel has 800 × 600.
constexpr float kEdge = 16, kGap = 8;
constexpr float kColumn = 228;  // width of the column of buttons that every page has
constexpr float kPageX = kEdge + kColumn + 24, kPageWidth = 800 - kEdge - kPageX, kPageHeight = kPageWidth;
constexpr float kButton = 60;  // height

constexpr double kConfirmSeconds = 4, kScaleStep = 1.25;
constexpr double kEyeStep = 0.05, kLeastEyes = 0.5, kMostEyes = 2.5, kUsualEyes = 1.6;  // m

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

void showScale(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes, float y) {
  const bool known = positive(model.unitsPerMetre);
  const MenuRect above = sheet.rect(kPageX, y, kPageWidth, 36);
  sheet.text("Scale", above, kMenuDim, 0);
  sheet.text(known ? fmt::format("1 m = {:.3g} units", model.unitsPerMetre) : "1 m = ?", above, kMenuText, 1);
  constexpr float kWidth = (kPageWidth - 2 * kGap) / 3;
  const auto at = [&](int i) { return sheet.rect(kPageX + float(i) * (kWidth + kGap), y + 38, kWidth, kButton); };
  if (sheet.button("smaller", MenuSign::minus, at(0))) wishes.scaleFactor = 1 / kScaleStep;
  if (sheet.button("larger", MenuSign::plus, at(1))) wishes.scaleFactor = kScaleStep;
  if (!sheet.button("first scale", "Reset", at(2)) || !known) return;
  const double factor = model.firstUnitsPerMetre / model.unitsPerMetre;
  if (positive(factor)) wishes.scaleFactor = factor;
}

void showTurn(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes, float y) {
  sheet.text("Turn by", sheet.rect(kPageX, y, kPageWidth, 36), kMenuDim, 0);
  constexpr std::array kDegrees{15, 30, 45, 90};
  constexpr float kWidth = (kPageWidth - 3 * kGap) / 4;
  for (std::size_t i = 0; i < kDegrees.size(); ++i) {
    const bool marked = std::abs(model.snapDegrees - kDegrees[i]) < 0.5;
    if (sheet.button(fmt::format("turn {}", kDegrees[i]), fmt::format("{}°", kDegrees[i]),
                     sheet.rect(kPageX + float(i) * (kWidth + kGap), y + 38, kWidth, kButton),
                     marked ? MenuLook::marked : MenuLook::plain))
      wishes.snapDegrees = kDegrees[i];
  }
}

void showEyes(MenuSheet& sheet, double height, MenuWishes& wishes, float y) {
  const bool known = std::isfinite(height);
  const auto wish = [&](double step) {
    wishes.eyeHeight = std::clamp(known ? height + step : kUsualEyes, kLeastEyes, kMostEyes);
  };
  const MenuRect above = sheet.rect(kPageX, y, kPageWidth, 36);
  sheet.text("Eye height", above, kMenuDim, 0);
  sheet.text(known ? fmt::format("{:.2f} m", height) : "?", above, kMenuText, 1);
  constexpr float kWidth = (kPageWidth - kGap) / 2;
  if (sheet.button("lower", MenuSign::minus, sheet.rect(kPageX, y + 38, kWidth, kButton))) wish(-kEyeStep);
  if (sheet.button("higher", MenuSign::plus, sheet.rect(kPageX + kWidth + kGap, y + 38, kWidth, kButton)))
    wish(kEyeStep);
}

void showSettings(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes) {
  showScale(sheet, model, wishes, kEdge);
  showTurn(sheet, model, wishes, kEdge + 110);
  float y = kEdge + 226;
  const auto row = [&] { return sheet.rect(kPageX, y, kPageWidth, kButton); };
  if (sheet.toggle("smooth motion", "Walk with the stick", row(), model.smoothMotion))
    wishes.smoothMotion = !model.smoothMotion;
  y += kButton + kGap;
  if (model.governor) {
    if (sheet.toggle("governor", "Draw less to keep pace", row(), *model.governor)) wishes.governor = !*model.governor;
    y += kButton + kGap;
  }
  if (!model.composition.empty()) {
    wishes.nextComposition = sheet.button("composition", "Composition: " + model.composition, row());
    y += kButton + kGap;
  }
  if (model.eyeHeight) showEyes(sheet, *model.eyeHeight, wishes, y + 4);
}

void showLine(MenuSheet& sheet, const MenuModel& model) {
  constexpr float kWidth = 800 - 2 * kEdge;
  sheet.text(model.line, sheet.rect(kEdge, 548, kWidth, 40), kMenuDim, 0);
  if (!model.loading) return;
  const double part = std::isfinite(*model.loading) ? std::clamp(*model.loading, 0.0, 1.0) : 0;
  const MenuRect all = sheet.rect(kEdge, 538, kWidth, 8);
  sheet.list.AddRectFilled(all.low, all.high, kMenuField, 4 * sheet.unit);
  const MenuRect done = sheet.rect(kEdge, 538, std::max(8.0f, float(part) * kWidth), 8);
  sheet.list.AddRectFilled(done.low, done.high, kMenuHere, 4 * sheet.unit);
}

}  // namespace

void Menu::reset() {
  *this = {};
}

void Menu::showColumn(MenuSheet& sheet, MenuWishes& wishes) {
  float y = kEdge;
  const auto next = [&](float gap) {
    const MenuRect at = sheet.rect(kEdge, y, kColumn, kButton);
    y += kButton + gap;
    return at;
  };
  const auto page = [&](const char* name, const char* label, Page which, float gap) {
    const MenuLook look = page_ == which ? MenuLook::marked : MenuLook::plain;
    if (sheet.button(name, label, next(gap), look)) page_ = which;
  };
  page("map page", "Map", Page::map, kGap);
  page("scenes page", "Scenes", Page::scenes, kGap);
  page("settings page", "Settings", Page::settings, 28);
  wishes.picture = sheet.button("picture", "Picture", next(kGap));
  wishes.recentre = sheet.button("recentre", "Recentre", next(28));
  wishes.close = sheet.button("close", "Close", next(kGap));
  showExit(sheet, wishes, y);
}

// The first press asks for confirmation; a second press within kConfirmSeconds exits.
void Menu::showExit(MenuSheet& sheet, MenuWishes& wishes, float y) {
  exitSeconds_ = std::max(0.0, exitSeconds_ - double(ImGui::GetIO().DeltaTime));
  const bool asks = exitSeconds_ > 0;
  const MenuRect at = sheet.rect(kEdge, y, kColumn, kButton);
  if (!sheet.button("exit", asks ? "Really exit?" : "Exit", at, asks ? MenuLook::warning : MenuLook::plain)) {
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left)) exitSeconds_ = 0;  // anywhere else
    return;
  }
  wishes.exit = asks;
  exitSeconds_ = asks ? 0 : kConfirmSeconds;
}

void Menu::showScenes(MenuSheet& sheet, const MenuModel& model, MenuWishes& wishes) {
  constexpr std::size_t kRows = 7;
  constexpr float kRow = 66, kScroll = 72;
  const std::size_t count = model.scenes.size();
  if (count == 0) sheet.text("No scenes", sheet.rect(kPageX, kEdge, kPageWidth, kPageHeight), kMenuDim);
  const std::size_t last = count > kRows ? count - kRows : 0;  // last possible first row
  if (model.scene != seenScene_) {
    seenScene_ = model.scene;
    const std::size_t scene = model.scene.value_or(0);
    if (scene < firstScene_ || scene >= firstScene_ + kRows) firstScene_ = scene > 3 ? scene - 3 : 0;
  }
  firstScene_ = std::min(firstScene_, last);
  const float width = kPageWidth - (last > 0 ? kScroll + kGap : 0);
  for (std::size_t row = 0; row < kRows && firstScene_ + row < count; ++row) {
    const std::size_t i = firstScene_ + row;
    const bool current = model.scene == i;
    if (sheet.button(fmt::format("scene {}", i), model.scenes[i],
                     sheet.rect(kPageX, kEdge + float(row) * (kRow + kGap), width, kRow),
                     current ? MenuLook::marked : MenuLook::plain) &&
        !current)
      wishes.scene = i;
  }
  if (last == 0) return;
  const float x = kPageX + width + kGap, height = float(kRows) * (kRow + kGap) - kGap;
  const auto scroll = [&](const char* name, MenuSign sign, float y) {
    return sheet.button(name, sign, sheet.rect(x, y, kScroll, 140));
  };
  if (scroll("scenes up", MenuSign::up, kEdge)) firstScene_ -= std::min(firstScene_, kRows - 1);
  if (scroll("scenes down", MenuSign::down, kEdge + height - 140))
    firstScene_ = std::min(firstScene_ + kRows - 1, last);
  sheet.text(fmt::format("{}", firstScene_ + 1), sheet.rect(x, kEdge + 0.5f * height - 50, kScroll, 34), kMenuDim);
  sheet.text("of", sheet.rect(x, kEdge + 0.5f * height - 17, kScroll, 34), kMenuDim);
  sheet.text(fmt::format("{}", count), sheet.rect(x, kEdge + 0.5f * height + 16, kScroll, 34), kMenuDim);
}

MenuWishes Menu::show(const MenuModel& model, glm::vec2 pixels) {
  MenuWishes wishes;
  items_.clear();
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({pixels.x, pixels.y});
  ImGui::Begin("menu", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse);
  MenuSheet sheet{std::min(pixels.x / 800, pixels.y / 600), items_, *ImGui::GetWindowDrawList()};
  showColumn(sheet, wishes);
  if (page_ == Page::map) showMap(sheet, model, wishes);
  if (page_ == Page::scenes) showScenes(sheet, model, wishes);
  if (page_ == Page::settings) showSettings(sheet, model, wishes);
  showLine(sheet, model);
  ImGui::End();
  return wishes;
}

}  // namespace ibr::app
