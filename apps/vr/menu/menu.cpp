// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/menu.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vr/menu/menu_canvas.h"

namespace ibr::app {
namespace {

// Layout in units; the panel has 800 × 600.
constexpr float kEdge = 16, kGap = 8;
constexpr float kColumn = 228;  // width of the column of buttons that every page has
constexpr float kPageX = kEdge + kColumn + 24, kPageWidth = 800 - kEdge - kPageX, kPageHeight = kPageWidth;
constexpr float kButton = 60;  // height

constexpr double kConfirmSeconds = 4, kScaleStep = 1.25;
constexpr double kEyeHeightStep = 0.05, kMinEyeHeight = 0.5, kMaxEyeHeight = 2.5, kDefaultEyeHeight = 1.6;  // m

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

void showScale(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests, float y) {
  const bool known = positive(model.unitsPerMetre);
  const MenuRect above = canvas.rect(kPageX, y, kPageWidth, 36);
  canvas.text("Scale", above, kMenuDim, 0);
  canvas.text(known ? fmt::format("1 m = {:.3g} units", model.unitsPerMetre) : "1 m = ?", above, kMenuText, 1);
  constexpr float kWidth = (kPageWidth - 2 * kGap) / 3;
  const auto at = [&](int i) { return canvas.rect(kPageX + float(i) * (kWidth + kGap), y + 38, kWidth, kButton); };
  if (canvas.button("smaller", MenuIcon::minus, at(0))) requests.scaleFactor = 1 / kScaleStep;
  if (canvas.button("larger", MenuIcon::plus, at(1))) requests.scaleFactor = kScaleStep;
  if (!canvas.button("first scale", "Reset", at(2)) || !known) return;
  const double factor = model.initialUnitsPerMetre / model.unitsPerMetre;
  if (positive(factor)) requests.scaleFactor = factor;
}

void showTurn(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests, float y) {
  canvas.text("Turn by", canvas.rect(kPageX, y, kPageWidth, 36), kMenuDim, 0);
  constexpr std::array kDegrees{15, 30, 45, 90};
  constexpr float kWidth = (kPageWidth - 3 * kGap) / 4;
  for (std::size_t i = 0; i < kDegrees.size(); ++i) {
    const bool marked = std::abs(model.snapDegrees - kDegrees[i]) < 0.5;
    if (canvas.button(fmt::format("turn {}", kDegrees[i]), fmt::format("{}°", kDegrees[i]),
                      canvas.rect(kPageX + float(i) * (kWidth + kGap), y + 38, kWidth, kButton),
                      marked ? MenuButtonStyle::marked : MenuButtonStyle::plain))
      requests.snapDegrees = kDegrees[i];
  }
}

void showEyes(MenuCanvas& canvas, double height, MenuRequests& requests, float y) {
  const bool known = std::isfinite(height);
  const auto requestHeight = [&](double step) {
    requests.eyeHeight = std::clamp(known ? height + step : kDefaultEyeHeight, kMinEyeHeight, kMaxEyeHeight);
  };
  const MenuRect above = canvas.rect(kPageX, y, kPageWidth, 36);
  canvas.text("Eye height", above, kMenuDim, 0);
  canvas.text(known ? fmt::format("{:.2f} m", height) : "?", above, kMenuText, 1);
  constexpr float kWidth = (kPageWidth - kGap) / 2;
  if (canvas.button("lower", MenuIcon::minus, canvas.rect(kPageX, y + 38, kWidth, kButton)))
    requestHeight(-kEyeHeightStep);
  if (canvas.button("higher", MenuIcon::plus, canvas.rect(kPageX + kWidth + kGap, y + 38, kWidth, kButton)))
    requestHeight(kEyeHeightStep);
}

void showSettings(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests) {
  showScale(canvas, model, requests, kEdge);
  showTurn(canvas, model, requests, kEdge + 110);
  float y = kEdge + 226;
  const auto row = [&] { return canvas.rect(kPageX, y, kPageWidth, kButton); };
  if (canvas.toggle("smooth motion", "Walk with the stick", row(), model.smoothMotion))
    requests.smoothMotion = !model.smoothMotion;
  y += kButton + kGap;
  if (model.governor) {
    if (canvas.toggle("governor", "Draw less to keep pace", row(), *model.governor))
      requests.governor = !*model.governor;
    y += kButton + kGap;
  }
  if (!model.composition.empty()) {
    requests.nextComposition = canvas.button("composition", "Composition: " + model.composition, row());
    y += kButton + kGap;
  }
  if (model.eyeHeight) showEyes(canvas, *model.eyeHeight, requests, y + 4);
}

void showLine(MenuCanvas& canvas, const MenuModel& model) {
  constexpr float kWidth = 800 - 2 * kEdge;
  canvas.text(model.line, canvas.rect(kEdge, 548, kWidth, 40), kMenuDim, 0);
  if (!model.loading) return;
  const double part = std::isfinite(*model.loading) ? std::clamp(*model.loading, 0.0, 1.0) : 0;
  const MenuRect all = canvas.rect(kEdge, 538, kWidth, 8);
  canvas.list.AddRectFilled(all.low, all.high, kMenuField, 4 * canvas.unit);
  const MenuRect done = canvas.rect(kEdge, 538, std::max(8.0f, float(part) * kWidth), 8);
  canvas.list.AddRectFilled(done.low, done.high, kMenuCurrentSpot, 4 * canvas.unit);
}

}  // namespace

void Menu::reset() {
  *this = {};
}

void Menu::showColumn(MenuCanvas& canvas, MenuRequests& requests) {
  float y = kEdge;
  const auto next = [&](float gap) {
    const MenuRect at = canvas.rect(kEdge, y, kColumn, kButton);
    y += kButton + gap;
    return at;
  };
  const auto page = [&](const char* name, const char* label, Page which, float gap) {
    const MenuButtonStyle style = page_ == which ? MenuButtonStyle::marked : MenuButtonStyle::plain;
    if (canvas.button(name, label, next(gap), style)) page_ = which;
  };
  page("map page", "Map", Page::map, kGap);
  page("scenes page", "Scenes", Page::scenes, kGap);
  page("settings page", "Settings", Page::settings, 28);
  requests.picture = canvas.button("picture", "Picture", next(kGap));
  requests.recentre = canvas.button("recentre", "Recentre", next(28));
  requests.close = canvas.button("close", "Close", next(kGap));
  showExit(canvas, requests, y);
}

// The first press asks for confirmation; a second press within kConfirmSeconds exits.
void Menu::showExit(MenuCanvas& canvas, MenuRequests& requests, float y) {
  exitSeconds_ = std::max(0.0, exitSeconds_ - double(ImGui::GetIO().DeltaTime));
  const bool asks = exitSeconds_ > 0;
  const MenuRect at = canvas.rect(kEdge, y, kColumn, kButton);
  if (!canvas.button("exit", asks ? "Really exit?" : "Exit", at,
                     asks ? MenuButtonStyle::warning : MenuButtonStyle::plain)) {
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left)) exitSeconds_ = 0;  // anywhere else
    return;
  }
  requests.exit = asks;
  exitSeconds_ = asks ? 0 : kConfirmSeconds;
}

void Menu::showScenes(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests) {
  constexpr std::size_t kRows = 7;
  constexpr float kRow = 66, kScroll = 72;
  const std::size_t count = model.scenes.size();
  if (count == 0) canvas.text("No scenes", canvas.rect(kPageX, kEdge, kPageWidth, kPageHeight), kMenuDim);
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
    if (canvas.button(fmt::format("scene {}", i), model.scenes[i],
                      canvas.rect(kPageX, kEdge + float(row) * (kRow + kGap), width, kRow),
                      current ? MenuButtonStyle::marked : MenuButtonStyle::plain) &&
        !current)
      requests.scene = i;
  }
  if (last == 0) return;
  const float x = kPageX + width + kGap, height = float(kRows) * (kRow + kGap) - kGap;
  const auto scroll = [&](const char* name, MenuIcon sign, float y) {
    return canvas.button(name, sign, canvas.rect(x, y, kScroll, 140));
  };
  if (scroll("scenes up", MenuIcon::up, kEdge)) firstScene_ -= std::min(firstScene_, kRows - 1);
  if (scroll("scenes down", MenuIcon::down, kEdge + height - 140))
    firstScene_ = std::min(firstScene_ + kRows - 1, last);
  canvas.text(fmt::format("{}", firstScene_ + 1), canvas.rect(x, kEdge + 0.5f * height - 50, kScroll, 34), kMenuDim);
  canvas.text("of", canvas.rect(x, kEdge + 0.5f * height - 17, kScroll, 34), kMenuDim);
  canvas.text(fmt::format("{}", count), canvas.rect(x, kEdge + 0.5f * height + 16, kScroll, 34), kMenuDim);
}

MenuRequests Menu::show(const MenuModel& model, glm::vec2 pixels) {
  MenuRequests requests;
  items_.clear();
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({pixels.x, pixels.y});
  ImGui::Begin("menu", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse);
  MenuCanvas canvas{std::min(pixels.x / 800, pixels.y / 600), items_, *ImGui::GetWindowDrawList()};
  showColumn(canvas, requests);
  if (page_ == Page::map) showMap(canvas, model, requests);
  if (page_ == Page::scenes) showScenes(canvas, model, requests);
  if (page_ == Page::settings) showSettings(canvas, model, requests);
  showLine(canvas, model);
  ImGui::End();
  return requests;
}

}  // namespace ibr::app
