// SPDX-License-Identifier: Apache-2.0
// The menu's map: capture sites from above; pressing one teleports there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "vr/menu/menu_canvas.h"

namespace ibr::app {
namespace {

constexpr float kSide = 516;  // units
constexpr float kReach = 26;  // max. distance from the pointer to a chosen spot, units
constexpr ImU32 kSpot = IM_COL32(72, 190, 184, 255);

bool finite(glm::dvec2 at) {
  return std::isfinite(at.x) && std::isfinite(at.y);
}

struct Map {
  MenuRect rect;
  float unit, dot;  // pixels per unit; radius of a spot, pixels

  ImVec2 at(glm::dvec2 place) const {
    const glm::dvec2 held = glm::clamp(place, 0.0, 1.0);
    return {rect.low.x + float(held.x) * rect.size().x, rect.low.y + float(held.y) * rect.size().y};
  }
  glm::dvec2 placeAt(ImVec2 pixel) const {
    return {(pixel.x - rect.low.x) / rect.size().x, (pixel.y - rect.low.y) / rect.size().y};
  }
};

void drawSpot(ImDrawList& list, const Map& map, glm::dvec2 place, float radius, ImU32 colour) {
  const ImVec2 at = map.at(place);
  if (radius < 4)  // squares are faster for many spots
    list.AddRectFilled({at.x - radius, at.y - radius}, {at.x + radius, at.y + radius}, colour);
  else
    list.AddCircleFilled(at, radius, colour, 16);
}

void drawSpots(ImDrawList& list, const Map& map, const MenuModel& model) {
  for (const std::uint32_t spot : model.spots.drawn())
    if (spot != model.here) drawSpot(list, map, model.spots[spot], map.dot, kSpot);
  if (model.here && *model.here < model.spots.size() && finite(model.spots[*model.here]))
    drawSpot(list, map, model.spots[*model.here], std::max(map.dot, 6 * map.unit), kMenuCurrentSpot);
}

void drawHoveredSpot(MenuCanvas& canvas, const Map& map, ImVec2 at, std::size_t number) {
  canvas.list.AddCircleFilled(at, 15 * map.unit, kMenuText, 32);
  canvas.list.AddCircleFilled(at, 11 * map.unit, kMenuSelected, 32);
  const std::string words = fmt::format("{}", number);
  const float width = ImGui::CalcTextSize(words.c_str()).x + 28 * map.unit, height = 40 * map.unit;
  const float x = std::clamp(at.x - 0.5f * width, map.rect.low.x, map.rect.high.x - width);
  float y = at.y - 22 * map.unit - height;
  if (y < map.rect.low.y) y = at.y + 34 * map.unit;  // below the pointer, else the pointer hides the text
  const MenuRect box{{x, y}, {x + width, y + height}};
  canvas.list.AddRectFilled(box.low, box.high, kMenuText, 6 * map.unit);
  canvas.text(words, box, kMenuBackground);
}

// Drawn over the spots, to be visible among thousands of them.
void drawPerson(ImDrawList& list, const Map& map, glm::dvec2 place, glm::dvec2 facing) {
  const ImVec2 at = map.at(place);
  const double length = glm::length(facing);
  if (!std::isfinite(length) || length <= 0) {
    list.AddCircleFilled(at, 10 * map.unit, kMenuBackground, 24);
    list.AddCircleFilled(at, 7 * map.unit, kMenuText, 24);
    return;
  }
  const glm::vec2 ahead(facing / length), aside(-ahead.y, ahead.x);
  const auto corner = [&](float forward, float sideways, float size) {
    const glm::vec2 by = size * map.unit * (forward * ahead + sideways * aside);
    return ImVec2{at.x + by.x, at.y + by.y};
  };
  for (const bool inner : {false, true}) {
    const float size = inner ? 17 : 25;
    const ImU32 colour = inner ? kMenuText : kMenuBackground;
    // Two triangles: an arrow head with a notch.
    list.AddTriangleFilled(corner(1.25f, 0, size), corner(-0.9f, 0.8f, size), corner(-0.45f, 0, size), colour);
    list.AddTriangleFilled(corner(1.25f, 0, size), corner(-0.45f, 0, size), corner(-0.9f, -0.8f, size), colour);
  }
}

}  // namespace

// Chooses the spot under the pointer at the start of the press, because the hand shakes while pressing.
void Menu::showMap(MenuCanvas& canvas, const MenuModel& model, MenuRequests& requests) {
  const float crowd = kSide / std::sqrt(float(std::max<std::size_t>(model.spots.drawn().size(), 1)));
  const Map map{canvas.rect(784 - kSide, 16, kSide, kSide), canvas.unit,
                canvas.unit * std::clamp(0.18f * crowd, 1.6f, 10.0f)};
  canvas.list.AddRectFilled(map.rect.low, map.rect.high, kMenuField, 9 * canvas.unit);
  const bool chosen = canvas.area("map", map.rect);
  std::optional<std::size_t> hovered;
  if (ImGui::IsItemHovered()) hovered = model.spots.nearest(map.placeAt(ImGui::GetIO().MousePos), kReach / kSide);
  if (ImGui::IsItemActivated()) pressedSpot_ = hovered;
  if (pressedSpot_ && *pressedSpot_ >= model.spots.size()) pressedSpot_.reset();  // the scene has changed
  if (chosen) requests.teleport = pressedSpot_;
  if (ImGui::IsItemActive()) hovered = pressedSpot_;
  if (!ImGui::IsItemActive()) pressedSpot_.reset();

  canvas.list.PushClipRect(map.rect.low, map.rect.high, true);
  if (model.spots.size() == 0) canvas.text("No photographs", map.rect, kMenuDim);
  drawSpots(canvas.list, map, model);
  if (model.you && finite(*model.you)) drawPerson(canvas.list, map, *model.you, model.facing);
  if (hovered) drawHoveredSpot(canvas, map, map.at(model.spots[*hovered]), *hovered + 1);
  canvas.list.PopClipRect();
}

}  // namespace ibr::app
