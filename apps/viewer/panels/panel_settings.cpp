// SPDX-License-Identifier: Apache-2.0
#include <imgui.h>

#include <array>

#include "shared/cli/settings.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

void hint(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

// Draws a combo box. Returns true if the value changed.
template <class T, std::size_t N>
bool choose(const char* label, T& value, const std::array<std::pair<const char*, T>, N>& choices, const char* help) {
  const char* now = "";
  for (const auto& [word, meaning] : choices)
    if (meaning == value) now = word;
  bool changed = false;
  if (ImGui::BeginCombo(label, now)) {
    for (const auto& [word, meaning] : choices)
      if (ImGui::Selectable(word, meaning == value)) value = meaning, changed = true;
    ImGui::EndCombo();
  }
  hint(help);
  return changed;
}

bool slide(const char* label, double& value, double low, double high, const char* format, const char* help,
           ImGuiSliderFlags flags = 0) {
  float now = float(value);
  const bool changed =
      ImGui::SliderFloat(label, &now, float(low), float(high), format, flags | ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = double(now);
  hint(help);
  return changed;
}

bool count(const char* label, std::uint32_t& value, int low, int high, const char* help) {
  int now = int(value);
  const bool changed = ImGui::SliderInt(label, &now, low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = std::uint32_t(now);
  hint(help);
  return changed;
}

bool chooseOverlay(RenderSettings& s) {
  bool changed = false;
  if (ImGui::BeginCombo("overlay", optionValue(s.overlay).word)) {
    for (const OverlayOption& line : kOverlays) {
      if (ImGui::Selectable(line.word, line.overlay == s.overlay)) s.overlay = line.overlay, changed = true;
      hint(line.shows);
    }
    ImGui::EndCombo();
  }
  hint("Diagnostic image over the rendered image or instead of it (O)");
  return changed;
}

bool sceneSettings(RenderSettings& s) {
  bool changed = false;
  using Way = std::pair<const char*, Composition>;
  changed |= choose("composition", s.composition,
                    std::array{Way{"cells", Composition::cells}, Way{"gathered", Composition::gathered},
                               Way{"hybrid", Composition::hybrid}},
                    "cells: morphing cells only; gathered: each pixel from the photographs that see it; "
                    "hybrid: cells where all members agree, gathered elsewhere (C)");
  if (s.composition != Composition::cells) {
    changed |= count("photographs", s.gatherCandidates, 1, int(kMaxGatherCandidates),
                     "Maximum number of photographs per frame to gather from");
    changed |= count("colours", s.gatherColours, 1, int(kMaxGatherColours),
                     "Maximum number of photographs averaged in a gathered pixel");
  }
  using Blend = std::pair<const char*, BlendMode>;
  changed |= choose("blending", s.blend,
                    std::array{Blend{"blend", BlendMode::blend}, Blend{"dither", BlendMode::dither},
                               Blend{"mixed", BlendMode::mixed}},
                    "blend: weighted sum of the photographs; dither: one photograph per pixel, faster and sharper");
  using Colour = std::pair<const char*, ColourMapping>;
  changed |= choose("colour mapping", s.colourMapping,
                    std::array{Colour{"off", ColourMapping::off}, Colour{"mapped", ColourMapping::ours}},
                    "mapped: colours of all cells are matched to the main cell, which hides differences of exposure");
  using Light = std::pair<const char*, Exposure>;
  changed |=
      choose("exposure", s.exposure,
             std::array{Light{"off", Exposure::off}, Light{"scene mean", Exposure::scene},
                        Light{"adapted", Exposure::adapted}},
             "Exposure of the photographs: unchanged (off), the mean of the scene, or the mean of the photographs in "
             "the main cell (adapted)");
  changed |= ImGui::Checkbox("align cells", &s.alignCells);
  hint("Shift cells that share photographs slightly until the cells agree, for inaccurate poses");
  changed |= count("cells", s.maxCells, 1, int(kMaxCellCount), "Maximum number of cells to draw, best first");
  const auto tier = [&] {
    return ImGui::SliderInt("maximum tier", &s.maxTier, 0, 3, "%d", ImGuiSliderFlags_AlwaysClamp);
  };
  changed |= tier();
  hint("0: depth confirmed by several photographs; 2: adds unconfirmed depth; 3: fills holes");
  changed |= slide("extrapolation", s.extrapolationLimit, 0, 8, "%.2f cells",
                   "Cells farther away than this many times their size are not drawn");
  changed |= slide("cross-fade", s.switchSeconds, 0, 2, "%.2f s", "Duration after a change of the main cell; 0: cut");
  changed |= slide("render scale", s.renderScale, 0.25, 2, "%.2f", "Below 1: faster and softer");
  changed |=
      slide("texture scale", s.textureScale, 0.125, 2, "%.2f", "Below 1: coarser photographs, less memory traffic");
  changed |= chooseOverlay(s);
  return changed;
}

bool modelSettings(HtmSettings& s) {
  bool changed = false;
  using Method = std::pair<const char*, HtmMethod>;
  changed |=
      choose("method", s.method,
             std::array{Method{"harmonised", HtmMethod::harmonised}, Method{"blended (VDTBM)", HtmMethod::blended},
                        Method{"vertex colours (VDVBM)", HtmMethod::vertexColours}},
             "harmonised: photographs are displaced until they agree, then blended");
  changed |= slide("gamma", s.gamma, 1, 1000, "%.0f", "Preference for cameras that look in the view's direction",
                   ImGuiSliderFlags_Logarithmic);
  changed |= slide("smoothing", s.smoothingSeconds, 0, 2, "%.2f s", "Time constant with which weights follow the view");
  return changed;
}

}  // namespace

void showSettings(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  if (item.scene) showPresets(input);
  ImGui::PushItemWidth(-9 * ImGui::GetFontSize());
  if (item.scene ? sceneSettings(item.settings) : modelSettings(item.htmSettings)) settingsChanged(item);
  ImGui::PopItemWidth();
}

}  // namespace ibr::app
