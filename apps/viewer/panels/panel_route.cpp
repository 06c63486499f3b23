// SPDX-License-Identifier: Apache-2.0
// Page "Path": the camera path, key by key.
#include <fmt/format.h>
#include <imgui.h>

#include "shared/camera/path_recorder.h"
#include "viewer/panels/panels.h"

namespace ibr::app {

void showRoute(PanelInput& input) {
  OpenItem& place = *input.viewer.place();
  CameraPath& route = place.route;
  if (ImGui::Button("add key (K)")) place.addRouteKey();
  ImGui::SameLine();
  if (ImGui::Button(place.showingRoute ? "stop" : "play (J)")) {
    if (place.showingRoute)
      place.showingRoute = false;
    else
      place.showRoute();
  }
  if (ImGui::Button("save (ctrl S)")) input.viewer.wantsRoute = true;
  if (ImGui::Button("video (ctrl M)")) input.viewer.wantsVideo = true;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Rendered in the background, at the window's size, with the current settings");
  ImGui::Checkbox("loop", &place.repeatingRoute);
  if (route.keys.empty()) {
    ImGui::TextWrapped(
        "A key stores the current view. The camera follows a spline through the keys. ibr render --poses renders "
        "a saved path exactly as the viewer plays it.");
    return;
  }
  if (route.keys.size() > 1) {
    float seconds = float(route.keys.back().time - route.keys.front().time);
    if (ImGui::SliderFloat("seconds", &seconds, 0.5f, 120, "%.1f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
      retimeToLast(route, double(seconds));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Duration from the first to the last key, at constant speed");
  }
  if (ImGui::BeginChild("keys"))
    for (std::size_t k = 0; k < route.keys.size(); ++k) {
      const CameraKey& key = route.keys[k];
      ImGui::PushID(int(k));
      if (ImGui::SmallButton("x")) {
        deleteKey(route, k);
        place.showingRoute = false;
        ImGui::PopID();
        break;
      }
      ImGui::SameLine();
      if (ImGui::Selectable(
              fmt::format("{:7.2f} s   {:.3f} {:.3f} {:.3f}", key.time, key.position.x, key.position.y, key.position.z)
                  .c_str())) {
        flyTo(place.walk, {key.position, key.rotation}, key.fovY, 0.6);
        place.changed = true;
      }
      ImGui::PopID();
    }
  ImGui::EndChild();
}

}  // namespace ibr::app
