// SPDX-License-Identifier: Apache-2.0
// Legend of an overlay. Its colours come from the same functions as the shaders'.
#include <fmt/format.h>
#include <imgui.h>

#include <cmath>
#include <functional>

#include "shared/cli/settings.h"
#include "shared/overlay.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

ImU32 packed(glm::vec3 colour) {
  return ImGui::ColorConvertFloat4ToU32({colour.x, colour.y, colour.z, 1});
}

void named(glm::vec3 colour, const std::string& what) {
  swatch(colour);
  ImGui::SameLine();
  ImGui::TextUnformatted(what.c_str());
}

// Draws a colour bar from 0 to 1 with labels below both ends.
void ramp(const std::function<glm::vec3(float)>& colour, const std::string& low, const std::string& high) {
  constexpr int kSteps = 64;
  const float width = 16 * ImGui::GetFontSize(), height = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  for (int i = 0; i < kSteps; ++i)
    ImGui::GetWindowDrawList()->AddRectFilled({at.x + width * float(i) / kSteps, at.y},
                                              {at.x + width * float(i + 1) / kSteps, at.y + height},
                                              packed(colour((float(i) + 0.5f) / kSteps)));
  ImGui::Dummy({width, height});
  ImGui::TextUnformatted(low.c_str());
  ImGui::SameLine(std::max(0.0f, width - ImGui::CalcTextSize(high.c_str()).x + ImGui::GetStyle().WindowPadding.x));
  ImGui::TextUnformatted(high.c_str());
}

// Interpolates geometrically from `low` to `high`.
float between(float low, float high, float share) {
  return low * std::pow(high / low, share);
}

void wireframe(const FramePlan& plan) {
  const auto n = float(plan.cells.size());
  ramp([n](float t) { return shader::rankColour(t * std::max(n - 1, 0.0f), n); }, "main cell",
       n > 1 ? fmt::format("cell of rank {}", plan.cells.size() - 1) : std::string());
}

void tiers() {
  named(shader::tierColour(kTierConsistent), "confirmed depth");
  named(shader::tierColour(kTierCompleted), "completed depth");
  named(shader::tierColour(kTierFilled), "hole, filled or empty");
}

void weights(const Scene& scene, const FramePlan& plan) {
  if (!plan.cells.empty()) {
    const std::vector<std::uint32_t>& members = scene.cells[plan.cells[0].cell].members;
    ImGui::Text("main cell, %u:", plan.cells[0].cell);
    for (std::size_t i = 0; i < members.size(); ++i)
      named(shader::memberColour(int(i)),
            fmt::format("{:3.0f} %  {}", 100 * plan.cells[0].view[0].blend[i], scene.nodes[members[i]].name));
  }
  if (!plan.photographs.empty()) ImGui::TextUnformatted("gathered pixels, best photograph first:");
  for (int i = 0; i < 4 && !plan.photographs.empty(); ++i) named(shader::memberColour(i), fmt::format("{}", i + 1));
}

void confidence() {
  const auto share = [](float t) { return between(shader::kMaxUncertainty, shader::kMinUncertainty, t); };
  ramp([&](float t) { return shader::confidenceColour(1, share(t)); },
       fmt::format("depth \u00b1{:.0f} % or unknown", 100 * share(0)), fmt::format("\u00b1{:.1f} %", 100 * share(1)));
}

void depth(const FramePlan& plan) {
  const auto distance = [](float t) { return between(shader::kNearestDepth, shader::kFarthestDepth, t); };
  ramp([&](float t) { return shader::depthColour(1 / distance(t), 1); },
       fmt::format("{:.3g}", distance(0) * float(plan.nearDistance)),
       fmt::format("{:.3g} world units or more", distance(1) * float(plan.nearDistance)));
}

void overlap() {
  constexpr int kShown = 12;
  for (int n = 0; n <= kShown; ++n) {
    if (n > 0) ImGui::SameLine(0, 6);
    ImGui::BeginGroup();
    swatch(shader::overlapColour(n));
    ImGui::Text("%d", n);
    ImGui::EndGroup();
  }
  ImGui::SameLine();
  ImGui::TextUnformatted("cells");
}

void agreement() {
  ramp([](float t) { return shader::agreementColour(t); }, "correlation 0 or less", "1");
  named(shader::unknownColour(), "unknown: no contrast, or only one photograph");
}

}  // namespace

void swatch(glm::vec3 colour) {
  const float side = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + side, at.y + side}, packed(colour));
  ImGui::Dummy({side, side});
}

void showLegend(PanelInput& input) {
  const OpenItem* item = input.viewer.item();
  if (!item || !item->scene || !input.plan || item->settings.overlay == Overlay::none) return;
  const OverlayOption& line = optionValue(item->settings.overlay);
  beginCard("legend", {10, ImGui::GetIO().DisplaySize.y - 10}, {0, 1});
  ImGui::Text("%s: %s", line.word, line.shows);
  switch (line.overlay) {
    case Overlay::none:
      break;
    case Overlay::wireframe:
      wireframe(*input.plan);
      break;
    case Overlay::tiers:
      tiers();
      break;
    case Overlay::weights:
      weights(*item->scene, *input.plan);
      break;
    case Overlay::confidence:
      confidence();
      break;
    case Overlay::depth:
      depth(*input.plan);
      break;
    case Overlay::overlap:
      overlap();
      break;
    case Overlay::agreement:
      agreement();
      break;
  }
  ImGui::End();
}

}  // namespace ibr::app
