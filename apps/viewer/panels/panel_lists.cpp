// SPDX-License-Identifier: Apache-2.0
// Pages "Cells" (in draw order) and "Log".
#include <imgui.h>

#include <algorithm>
#include <glm/trigonometric.hpp>

#include "shared/overlay.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

using Cells = std::vector<std::uint32_t>;

constexpr std::size_t kMaxHiddenCells = 1000;  // max. number of cells in view that are listed without being drawn

bool has(const Cells& cells, std::uint32_t cell) {
  return std::ranges::find(cells, cell) != cells.end();
}

// Draws a toggle button; light or dark shows its state, not colour alone. Returns true if clicked.
bool toggle(const char* letter, Cells& cells, std::uint32_t cell, const char* help) {
  const bool on = has(cells, cell);
  if (on) {
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.95f, 0.95f, 0.95f, 1));
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.05f, 0.05f, 0.05f, 1));
  }
  const bool clicked = ImGui::SmallButton(letter);
  if (on) ImGui::PopStyleColor(2);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
  if (clicked && on) std::erase(cells, cell);
  if (clicked && !on) cells.push_back(cell);
  return clicked;
}

bool muteAndSolo(RenderSettings& settings, std::uint32_t cell) {
  ImGui::PushID(int(cell));
  bool changed = toggle("M", settings.mutedCells, cell, "Mute: never draw this cell");
  ImGui::SameLine(0, 2);
  changed |= toggle("S", settings.soloCells, cell, "Solo: draw only the soloed cells");
  ImGui::PopID();
  return changed;
}

void photographsOf(const Scene& scene, std::uint32_t cell) {
  std::string names;
  for (const std::uint32_t member : scene.cells[cell].members)
    names += (names.empty() ? "" : ", ") + scene.nodes[member].name;
  ImGui::TextUnformatted(names.c_str());
}

// Draws a cell's row. Returns true if the cell was muted or soloed.
bool drawnCell(const Scene& scene, RenderSettings& settings, const FramePlan& plan, std::size_t rank) {
  const PlannedCell& cell = plan.cells[rank];
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  swatch(shader::rankColour(float(rank), float(plan.cells.size())));
  ImGui::SameLine();
  ImGui::Text("%zu%s", rank, cell.hidden ? " (hidden)" : "");
  ImGui::TableNextColumn();
  ImGui::Text("%u", cell.cell);
  ImGui::TableNextColumn();
  const bool changed = muteAndSolo(settings, cell.cell);
  ImGui::TableNextColumn();
  ImGui::Text("%.3f", cell.extrapolationDistance);
  ImGui::TableNextColumn();
  ImGui::Text("%.1f deg", glm::degrees(cell.rotationalDistance));
  ImGui::TableNextColumn();
  photographsOf(scene, cell.cell);
  return changed;
}

// Returns cells in view that were not chosen, at most kMaxHiddenCells, and muted or soloed cells that are not drawn,
// ascending.
Cells skippedCells(const Scene& scene, const RenderSettings& settings, const FramePlan& plan) {
  const Cells& hidden = plan.next.hiddenCells;
  Cells out(hidden.begin(), hidden.begin() + std::ptrdiff_t(std::min(hidden.size(), kMaxHiddenCells)));
  out.insert(out.end(), settings.mutedCells.begin(), settings.mutedCells.end());
  out.insert(out.end(), settings.soloCells.begin(), settings.soloCells.end());
  std::ranges::sort(out);
  out.erase(std::ranges::unique(out).begin(), out.end());
  std::erase_if(out, [&](std::uint32_t cell) {
    return cell >= scene.cells.size() || std::ranges::find(plan.cells, cell, &PlannedCell::cell) != plan.cells.end();
  });
  return out;
}

bool showSkippedCell(const Scene& scene, RenderSettings& settings, std::uint32_t cell) {
  const bool muted = has(settings.mutedCells, cell);
  const bool othersSolo = !settings.soloCells.empty() && !has(settings.soloCells, cell);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", muted ? "muted" : othersSolo ? "off" : "-");
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%u", cell);
  ImGui::TableNextColumn();
  const bool changed = muteAndSolo(settings, cell);
  ImGui::TableSetColumnIndex(5);
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  photographsOf(scene, cell);
  ImGui::PopStyleColor();
  return changed;
}

}  // namespace

void showCells(PanelInput& input) {
  if (!input.plan) {
    ImGui::TextUnformatted("harmonised models have no cells");
    return;
  }
  OpenItem& item = *input.viewer.item();
  const Scene& scene = *item.scene;
  const FramePlan& plan = *input.plan;
  RenderSettings& settings = item.settings;
  ImGui::TextWrapped("%zu of %zu cells; not drawn: %u outside the view, %u too far, %u over the maximum, %u by M and S",
                     plan.cells.size(), scene.cells.size(), plan.culledByFrustum, plan.culledByDistance,
                     plan.culledByCount, plan.culledByMuting);
  ImGui::BeginDisabled(settings.mutedCells.empty() && settings.soloCells.empty());
  if (ImGui::SmallButton("show all")) {
    settings.mutedCells.clear();
    settings.soloCells.clear();
    item.changed = true;
  }
  ImGui::EndDisabled();
  if (!ImGui::BeginTable("cells", 6,
                         ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingStretchProp))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  for (const char* name : {"rank", "cell", "", "outside", "angle", "photographs"}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  for (std::size_t rank = 0; rank < plan.cells.size(); ++rank) item.changed |= drawnCell(scene, settings, plan, rank);
  const Cells skipped = skippedCells(scene, settings, plan);
  ImGuiListClipper clipper;
  clipper.Begin(int(skipped.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
      item.changed |= showSkippedCell(scene, settings, skipped[std::size_t(i)]);
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
