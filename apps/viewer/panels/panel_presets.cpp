// SPDX-License-Identifier: Apache-2.0
// Preset buttons, with the measured cost and quality of each at the current view.
#include <imgui.h>

#include "shared/cli/presets.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

const char* descriptionOf(Preset preset) {
  switch (preset) {
    case Preset::fast:
      return "lowest frame time, holes stay";
    case Preset::balanced:
      return "the default";
    case Preset::accurate:
      return "every setting with a visible gain";
    case Preset::reference:
      return "maximum quality at any cost";
  }
  return "";
}

const ComparedSettings* effectNamed(const OpenItem& item, std::string_view name) {
  if (!item.comparison) return nullptr;
  for (const ComparedSettings& line : item.comparison->lines)
    if (line.name == name) return &line;
  return nullptr;
}

bool isOfThisView(const SettingsComparison& comparison, const OpenItem& item) {
  const Intrinsics& k = comparison.view.intrinsics;
  return sameView(comparison.view, cameraOf(item, {std::uint32_t(k.width), std::uint32_t(k.height)}));
}

}  // namespace

void settingsChanged(OpenItem& item) {
  item.changed = true;
  if (!item.comparison) return;
  item.comparison->lines.back() = {kCurrentSettingsName, item.settings, std::nullopt};
  item.comparison->lines.back().settings.overlay = Overlay::none;
}

void showPresets(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  const bool known = item.comparison && isOfThisView(*item.comparison, item);
  for (const auto& [name, chosen] : kPresets) {
    if (ImGui::Button(name, {5.5f * ImGui::GetFontSize(), 0})) {
      item.settings = withPreset(item.settings, chosen, input.deviceKind);
      settingsChanged(item);
    }
    ImGui::SameLine();
    const ComparedSettings* effect = known ? effectNamed(item, name) : nullptr;
    ImGui::TextUnformatted(effect ? text(*effect).c_str() : descriptionOf(chosen));
  }
  if (ImGui::Button("measure", {5.5f * ImGui::GetFontSize(), 0})) item.comparisonRequested = true;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "Draws this view with each preset and with the current settings. Shows the frame time on this\n"
        "device, and the PSNR against the reference preset.");
  ImGui::SameLine();
  if (known)
    ImGui::Text("current: %s", text(item.comparison->lines.back()).c_str());
  else
    ImGui::TextDisabled(item.comparison ? "the view has changed since" : "frame time and quality of this view");
  ImGui::Separator();
}

}  // namespace ibr::app
