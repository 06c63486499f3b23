// SPDX-License-Identifier: Apache-2.0
// Map of the image graph from above: photographs' positions, cells between them, and the current view. Of large scenes
// it draws at most kMaxMapMarks photographs and as many lines; each photograph can be clicked.
#include <imgui.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

// Maps world coordinates to panel coordinates.
struct Map {
  GraphView view;
  glm::dvec2 low{0}, high{1};
  ImVec2 corner, size;

  double scale() const {
    const glm::dvec2 extent = high - low;
    return std::min(double(size.x) / extent.x, double(size.y) / extent.y);
  }
  ImVec2 at(const glm::dvec2& flat) const {
    const glm::dvec2 from = (flat - 0.5 * (low + high)) * scale();
    return {corner.x + 0.5f * size.x + float(from.x), corner.y + 0.5f * size.y - float(from.y)};
  }
  ImVec2 at(const glm::dvec3& world) const { return at(view.flat(world)); }
  glm::dvec2 flatAt(ImVec2 pixel) const {
    const glm::dvec2 from(pixel.x - corner.x - 0.5f * size.x, corner.y + 0.5f * size.y - pixel.y);
    return 0.5 * (low + high) + from / scale();
  }
};

}  // namespace

void showMap(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  const MapMarks& marks = item.mapMarks;
  Map map{item.map, {}, {}, ImGui::GetCursorScreenPos(), ImGui::GetContentRegionAvail()};
  map.size = {std::max(map.size.x, 50.0f), std::max(map.size.y, 50.0f)};
  const glm::dvec2 here = map.view.flat(item.navigation.pose.position);
  map.low = glm::min(marks.low, here) - item.step;
  map.high = glm::max(marks.high, here) + item.step;

  ImDrawList& list = *ImGui::GetWindowDrawList();
  ImGui::InvisibleButton("map", map.size);
  const bool pressed = ImGui::IsItemClicked();
  list.PushClipRect(map.corner, {map.corner.x + map.size.x, map.corner.y + map.size.y}, true);
  for (const auto& [a, b] : marks.lines) list.AddLine(map.at(a), map.at(b), IM_COL32(120, 130, 140, 90));
  if (input.plan && !input.plan->cells.empty()) {
    const Cell& best = item.scene->cells[input.plan->cells[0].cell];
    for (std::size_t a = 0; a < best.members.size(); ++a)
      for (std::size_t b = a + 1; b < best.members.size(); ++b)
        list.AddLine(map.at(marks.photographs[best.members[a]]), map.at(marks.photographs[best.members[b]]),
                     IM_COL32(253, 231, 37, 255), 2);
  }
  const float dot = 0.2f * ImGui::GetFontSize(), look = 0.9f * ImGui::GetFontSize();
  const auto arrow = [&](const Pose& pose, ImU32 colour, float length) {
    const ImVec2 from = map.at(pose.position);
    const glm::dvec3 forward = pose.rotation * glm::dvec3(0, 0, -1);
    const glm::dvec2 flat(glm::dot(forward, map.view.right), glm::dot(forward, map.view.up));
    list.AddLine(from, {from.x + length * float(flat.x), from.y - length * float(flat.y)}, colour, 1.5f);
    list.AddCircleFilled(from, dot, colour);
  };
  for (const std::uint32_t i : marks.photographs.drawn())
    arrow(item.viewpoints[i].camera.pose, IM_COL32(33, 145, 140, 255), look);
  if (ImGui::IsItemHovered())
    if (const auto at = marks.photographs.nearest(map.flatAt(ImGui::GetIO().MousePos), 3 * double(dot) / map.scale())) {
      ImGui::SetTooltip("%s", item.viewpoints[*at].name.c_str());
      if (pressed) item.flyToViewpoint(*at);
    }
  arrow(item.navigation.pose, IM_COL32(255, 255, 255, 255), 1.6f * look);
  list.PopClipRect();
}

}  // namespace ibr::app
