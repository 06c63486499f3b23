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
  ImGui::BeginDisabled(!overlaysGoWith(s));
  if (ImGui::BeginCombo("overlay", wordOf(s.overlay).word)) {
    for (const OverlayWord& line : kOverlays) {
      if (ImGui::Selectable(line.word, line.overlay == s.overlay)) s.overlay = line.overlay, changed = true;
      hint(line.shows);
    }
    ImGui::EndCombo();
  }
  hint("What is shown over the picture or in its place (O)");
  ImGui::EndDisabled();
  return changed;
}

bool sceneSettings(RenderSettings& s) {
  bool changed = false;
  using Way = std::pair<const char*, Composition>;
  changed |= choose("composition", s.composition,
                    std::array{Way{"cells", Composition::cells}, Way{"gathered", Composition::gathered},
                               Way{"hybrid", Composition::hybrid}},
                    "cells: morphing cells alone; gathered: every pixel from the photographs that saw it; "
                    "hybrid: cells where all members agree, the rest gathered (C)");
  if (s.composition != Composition::cells) {
    changed |= count("photographs", s.gatherCandidates, 1, int(kMaxGatherCandidates),
                     "At most so many vote for depth and are gathered from in a frame");
    changed |= count("colours", s.gatherColours, 1, int(kMaxGatherColours),
                     "At most so many photographs are mixed in a gathered pixel");
  }
  using Blend = std::pair<const char*, BlendMode>;
  changed |= choose("blending", s.blend,
                    std::array{Blend{"blend", BlendMode::blend}, Blend{"dither", BlendMode::dither},
                               Blend{"mixed", BlendMode::mixed}},
                    "blend: weighted sum of the photographs; dither: one of them a pixel, faster and sharper");
  using Colour = std::pair<const char*, ColourMapping>;
  changed |= choose("colours", s.colourMapping,
                    std::array{Colour{"as photographed", ColourMapping::off}, Colour{"mapped", ColourMapping::ours}},
                    "mapped: cells take on the colours of the one that is best, so that exposures do not show");
  using Light = std::pair<const char*, Exposure>;
  changed |=
      choose("exposure", s.exposure,
             std::array{Light{"as photographed", Exposure::off}, Light{"the scene's mean", Exposure::scene},
                        Light{"adapted", Exposure::adapted}},
             "Photographs whose exposure was measured are shown with one: that of all of them in the mean, or of "
             "those that are nearest");
  using Shape = std::pair<const char*, Morph>;
  changed |= choose("morphing", s.morph, std::array{Shape{"ours", Morph::ours}, Shape{"the paper's", Morph::paper}},
                    "ours: right for static points everywhere; the paper's: unclamped weights, no depth");
  changed |= ImGui::Checkbox("cells aligned", &s.alignCells);
  hint("Cells that share photographs move a little, so that they agree where poses are wrong");
  changed |= count("cells", s.maxCells, 1, int(kMaxCellCount), "At most so many are drawn, best first");
  const auto tier = [&] {
    return ImGui::SliderInt("lowest tier", &s.maxTier, 0, 3, "%d", ImGuiSliderFlags_AlwaysClamp);
  };
  changed |= tier();
  hint("0: what photographs agree on; 2: also what no second one confirms; 3: holes are filled");
  changed |= slide("extrapolation", s.extrapolationLimit, 0, 8, "%.2f cells",
                   "Cells further off than this many of their sizes are not drawn");
  changed |= slide("switches", s.switchSeconds, 0, 2, "%.2f s", "A change of the main cell is mixed over so long");
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
             "harmonised: photographs are bent to agree before they are blended");
  changed |= slide("gamma", s.gamma, 1, 1000, "%.0f", "How strongly cameras that look alike count more than others",
                   ImGuiSliderFlags_Logarithmic);
  changed |= slide("smoothing", s.smoothSeconds, 0, 2, "%.2f s", "Time constant with which weights follow the view");
  return changed;
}

}  // namespace

void showSettings(PanelInput& input) {
  OpenItem& place = *input.viewer.place();
  if (place.scene) showPresets(input);
  ImGui::PushItemWidth(-9 * ImGui::GetFontSize());
  if (place.scene ? sceneSettings(place.settings) : modelSettings(place.htmSettings)) settingsChanged(place);
  ImGui::PopItemWidth();
}

}  // namespace ibr::app
