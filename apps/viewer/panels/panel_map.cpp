// SPDX-License-Identifier: Apache-2.0
// Map of the image graph from above: photographs' positions, cells between them, and the current view.
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

  ImVec2 at(const glm::dvec3& world) const {
    const glm::dvec2 flat = view.flat(world), extent = high - low;
    const double scale = std::min(double(size.x) / extent.x, double(size.y) / extent.y);
    const glm::dvec2 from = flat - 0.5 * (low + high);
    return {corner.x + 0.5f * size.x + float(from.x * scale), corner.y + 0.5f * size.y - float(from.y * scale)};
  }
};

}  // namespace

void showMap(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  Map map{item.map, {}, {}, ImGui::GetCursorScreenPos(), ImGui::GetContentRegionAvail()};
  map.size = {std::max(map.size.x, 50.0f), std::max(map.size.y, 50.0f)};
  map.low = map.high = map.view.flat(item.viewpoints.front().camera.pose.position);
  const auto include = [&](const glm::dvec3& world) {
    map.low = glm::min(map.low, map.view.flat(world));
    map.high = glm::max(map.high, map.view.flat(world));
  };
  for (const Viewpoint& v : item.viewpoints) include(v.camera.pose.position);
  include(item.navigation.pose.position);
  map.low -= item.step;
  map.high += item.step;

  ImDrawList& list = *ImGui::GetWindowDrawList();
  ImGui::InvisibleButton("map", map.size);
  const bool pressed = ImGui::IsItemClicked();
  list.PushClipRect(map.corner, {map.corner.x + map.size.x, map.corner.y + map.size.y}, true);
  if (item.scene)
    for (const Cell& cell : item.scene->cells)
      for (std::size_t a = 0; a < cell.members.size(); ++a)
        for (std::size_t b = a + 1; b < cell.members.size(); ++b)
          list.AddLine(map.at(item.viewpoints[cell.members[a]].camera.pose.position),
                       map.at(item.viewpoints[cell.members[b]].camera.pose.position), IM_COL32(120, 130, 140, 90));
  if (input.plan && !input.plan->cells.empty()) {
    const Cell& best = item.scene->cells[input.plan->cells[0].cell];
    for (std::size_t a = 0; a < best.members.size(); ++a)
      for (std::size_t b = a + 1; b < best.members.size(); ++b)
        list.AddLine(map.at(item.viewpoints[best.members[a]].camera.pose.position),
                     map.at(item.viewpoints[best.members[b]].camera.pose.position), IM_COL32(253, 231, 37, 255), 2);
  }
  const float dot = 0.2f * ImGui::GetFontSize(), look = 0.9f * ImGui::GetFontSize();
  const auto arrow = [&](const Pose& pose, ImU32 colour, float length) {
    const ImVec2 from = map.at(pose.position);
    const glm::dvec3 forward = pose.rotation * glm::dvec3(0, 0, -1);
    const glm::dvec2 flat(glm::dot(forward, map.view.right), glm::dot(forward, map.view.up));
    list.AddLine(from, {from.x + length * float(flat.x), from.y - length * float(flat.y)}, colour, 1.5f);
    list.AddCircleFilled(from, dot, colour);
    return from;
  };
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (std::size_t i = 0; i < item.viewpoints.size(); ++i) {
    const ImVec2 at = arrow(item.viewpoints[i].camera.pose, IM_COL32(33, 145, 140, 255), look);
    const float dx = mouse.x - at.x, dy = mouse.y - at.y;
    if (!ImGui::IsItemHovered() || dx * dx + dy * dy > 9 * dot * dot) continue;
    ImGui::SetTooltip("%s", item.viewpoints[i].name.c_str());
    if (pressed) item.flyToViewpoint(i);
  }
  arrow(item.navigation.pose, IM_COL32(255, 255, 255, 255), 1.6f * look);
  list.PopClipRect();
}

}  // namespace ibr::app
