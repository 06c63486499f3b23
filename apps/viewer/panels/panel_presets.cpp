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

const Effect* effectNamed(const OpenItem& place, std::string_view name) {
  if (!place.effects) return nullptr;
  for (const Effect& line : place.effects->lines)
    if (line.name == name) return &line;
  return nullptr;
}

bool isOfThisView(const Effects& effects, const OpenItem& place) {
  const Intrinsics& k = effects.view.intrinsics;
  return sameView(effects.view, cameraOf(place, {std::uint32_t(k.width), std::uint32_t(k.height)}));
}

}  // namespace

void settingsChanged(OpenItem& place) {
  place.changed = true;
  if (!place.effects) return;
  place.effects->lines.back() = {kAsSet, place.settings, std::nullopt};
  place.effects->lines.back().settings.overlay = Overlay::none;
}

void showPresets(PanelInput& input) {
  OpenItem& place = *input.viewer.place();
  const bool known = place.effects && isOfThisView(*place.effects, place);
  for (const auto& [name, chosen] : kPresets) {
    if (ImGui::Button(name, {5.5f * ImGui::GetFontSize(), 0})) {
      place.settings = presetOver(place.settings, chosen, input.deviceKind);
      settingsChanged(place);
    }
    ImGui::SameLine();
    const Effect* effect = known ? effectNamed(place, name) : nullptr;
    ImGui::TextUnformatted(effect ? text(*effect).c_str() : descriptionOf(chosen));
  }
  if (ImGui::Button("measure", {5.5f * ImGui::GetFontSize(), 0})) place.wantsEffects = true;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "Draws this view with each preset and with the current settings. Shows the frame time on this\n"
        "device, and the PSNR against the reference preset.");
  ImGui::SameLine();
  if (known)
    ImGui::Text("current: %s", text(place.effects->lines.back()).c_str());
  else
    ImGui::TextDisabled(place.effects ? "the view has changed since" : "frame time and quality of this view");
  ImGui::Separator();
}

}  // namespace ibr::app
