// SPDX-License-Identifier: Apache-2.0
// Cells in order, log.
#include <imgui.h>

#include <algorithm>
#include <glm/trigonometric.hpp>

#include "viewer/panels.h"

namespace ibr::app {
namespace {

// Of a colour-blind-safe ramp (viridis' ends and middle), 0 to 1.
ImVec4 heat(float share) {
  constexpr float kRamp[3][3]{{0.267f, 0.005f, 0.329f}, {0.128f, 0.567f, 0.551f}, {0.993f, 0.906f, 0.144f}};
  const float x = std::clamp(share, 0.0f, 1.0f) * 2;
  const int low = x < 1 ? 0 : 1;
  const float t = x - float(low);
  const auto mix = [&](int c) { return kRamp[low][c] * (1 - t) + kRamp[low + 1][c] * t; };
  return {mix(0), mix(1), mix(2), 1};
}

}  // namespace

void showCells(PanelInput& input) {
  if (!input.plan) {
    ImGui::TextUnformatted("A harmonised model has no cells.");
    return;
  }
  const Scene& scene = *input.viewer.place()->scene;
  const FramePlan& plan = *input.plan;
  ImGui::Text("%zu of %zu cells; not drawn: %u beyond the picture, %u too far, %u too many", plan.cells.size(),
              scene.cells.size(), plan.culledByFrustum, plan.culledByDistance, plan.culledByCount);
  if (!ImGui::BeginTable("cells", 5,
                         ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingStretchProp))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  for (const char* name : {"rank", "cell", "extrapolated", "turned", "photographs"}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  for (std::size_t rank = 0; rank < plan.cells.size(); ++rank) {
    const PlannedCell& cell = plan.cells[rank];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(heat(1 - float(rank) / 12), "%zu%s", rank, cell.hidden ? " (hidden)" : "");
    ImGui::TableNextColumn();
    ImGui::Text("%u", cell.cell);
    ImGui::TableNextColumn();
    ImGui::Text("%.3f", cell.extrapolationDistance);
    ImGui::TableNextColumn();
    ImGui::Text("%.1f deg", glm::degrees(cell.rotationalDistance));
    ImGui::TableNextColumn();
    std::string names;
    for (const std::uint32_t member : scene.cells[cell.cell].members)
      names += (names.empty() ? "" : ", ") + scene.nodes[member].name;
    ImGui::TextUnformatted(names.c_str());
  }
  ImGui::EndTable();
}

void showLog(PanelInput& input) {
  if (ImGui::BeginChild("log")) {
    ImGui::PushTextWrapPos(0);
    for (const LogLine& line : input.viewer.log) {
      const bool bad = line.level >= LogLevel::warning;
      if (bad) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.95f, 0.7f, 0.3f, 1));
      ImGui::TextUnformatted(line.text.c_str());
      if (bad) ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
    if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
  }
  ImGui::EndChild();
}

}  // namespace ibr::app
