// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "shared/overlay.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

const ImVec4 kNear(0.0f, 0.62f, 0.45f, 1), kFar(0.9f, 0.62f, 0.0f, 1);

// Shows the limit on the distance from the photographs, and the current distance.
void showRoaming(OpenItem& item) {
  ImGui::Checkbox("stay near the photographs (B)", &item.bounded);
  const double away = distanceTo(item.bounds, item.navigation.pose.position);
  ImGui::SameLine();
  ImGui::TextColored(away <= item.bounds.radius ? kNear : kFar, "%s",
                     away <= item.bounds.radius
                         ? "inside"
                         : fmt::format("{:.1f} steps outside", (away - item.bounds.radius) / item.step).c_str());
  float radius = float(item.bounds.radius / item.step);
  if (ImGui::SliderFloat("max. distance", &radius, 0.1f, 20, "%.2f steps",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
    item.bounds.radius = double(radius) * item.step;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("From a photograph, or from a line between neighbours; a step is the distance of neighbours");
}

struct TierText {
  std::size_t tier;
  const char* text;
};
constexpr std::array kTiers{TierText{kTierConsistent, "confirmed depth"}, TierText{kTierCompleted, "completed depth"},
                            TierText{kTierFilled, "holes, filled or empty"}};

// The colour of Overlay::tiers.
ImVec4 colourOf(std::size_t tier) {
  const glm::vec3 colour = shader::tierColour(std::uint32_t(tier));
  return {colour.x, colour.y, colour.z, 1};
}

// Shows the shares of the tiers in the image as a bar.
void showTrust(const std::optional<Trust>& trust) {
  const float height = 0.8f * ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + width, at.y + height}, IM_COL32(60, 60, 60, 255));
  float x = at.x;
  for (std::size_t tier = 0; trust && tier < trust->tiers.size(); ++tier) {
    const float share = width * float(trust->tiers[tier]);
    list.AddRectFilled({x, at.y}, {x + share, at.y + height}, ImGui::ColorConvertFloat4ToU32(colourOf(tier)));
    x += share;
  }
  ImGui::Dummy({width, height});
  if (ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    for (const auto& [tier, text] : kTiers)
      ImGui::TextColored(colourOf(tier), "%5.1f %% %s", trust ? 100 * trust->tiers[tier] : 0.0, text);
    ImGui::EndTooltip();
  }
  if (!trust) {
    ImGui::TextWrapped("trust is measured when the view is at rest");
    return;
  }
  const std::string depth =
      std::isfinite(trust->depthError) ? fmt::format("depth ±{:.1f} %", 100 * trust->depthError) : "depth unknown";
  const std::string item = !std::isfinite(trust->extrapolation) ? "no cell nearby"
                           : trust->extrapolation > 0
                               ? fmt::format("{:.2f} cell sizes outside the best cell", trust->extrapolation)
                               : "inside the best cell";
  ImGui::TextWrapped(
      "%s",
      fmt::format("{:.0f} % of the image has confirmed depth\n{}, {}", 100 * trust->tiers[0], depth, item).c_str());
}

}  // namespace

void showView(PanelInput& input) {
  Viewer& viewer = input.viewer;
  OpenItem& item = *viewer.item();
  const glm::dvec3 p = item.navigation.pose.position, forward = item.navigation.pose.rotation * glm::dvec3(0, 0, -1);
  ImGui::Text("position  %.3f  %.3f  %.3f", p.x, p.y, p.z);
  ImGui::Text("direction %.3f  %.3f  %.3f", forward.x, forward.y, forward.z);
  float degrees = float(glm::degrees(item.navigation.fovY));
  if (ImGui::SliderFloat("field of view", &degrees, 10, 120, "%.0f degrees", ImGuiSliderFlags_AlwaysClamp)) {
    item.navigation.fovY = glm::radians(double(degrees));
    item.changed = true;
  }
  float speed = float(item.navigation.speed / item.step);
  if (ImGui::SliderFloat("speed", &speed, 0.05f, 50, "%.2f steps/s",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
    item.navigation.speed = double(speed) * item.step;
  showRoaming(item);
  if (item.scene) showTrust(item.trust);
  if (ImGui::Checkbox("frusta and cells (G)", &item.showGraph)) item.changed = true;
  if (ImGui::Button("screenshot")) viewer.screenshotRequested = true;
  ImGui::SameLine();
  if (ImGui::Button("keys (F1)")) viewer.showHelp = !viewer.showHelp;

  ImGui::Separator();
  ImGui::Text("%zu photographs", item.viewpoints.size());
  if (ImGui::BeginChild("photographs")) {
    ImGuiListClipper clipper;
    clipper.Begin(int(item.viewpoints.size()));
    while (clipper.Step())
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
        const Viewpoint& v = item.viewpoints[std::size_t(i)];
        const double off = glm::distance(v.camera.pose.position, p);
        ImGui::PushID(i);
        if (ImGui::Selectable(fmt::format("{}   {:.2f} away", v.name, off).c_str(), off == 0))
          item.flyToViewpoint(std::size_t(i));
        ImGui::PopID();
      }
  }
  ImGui::EndChild();
}

}  // namespace ibr::app
