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
  if (ImGui::Button("key here (K)")) place.addRouteKey();
  ImGui::SameLine();
  if (ImGui::Button(place.showingRoute ? "stop" : "show (J)")) {
    if (place.showingRoute)
      place.showingRoute = false;
    else
      place.showRoute();
  }
  if (ImGui::Button("save (ctrl S)")) input.viewer.wantsRoute = true;
  if (ImGui::Button("video (ctrl M)")) input.viewer.wantsVideo = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Made beside the viewer, of the window's size, as it is drawn now");
  ImGui::Checkbox("again and again", &place.repeatingRoute);
  if (route.keys.empty()) {
    ImGui::TextWrapped(
        "Keys are put where the view is; the camera goes from each to the next along a spline. What is saved, "
        "ibr render --poses plays as it is shown here.");
    return;
  }
  if (route.keys.size() > 1) {
    float seconds = float(route.keys.back().time - route.keys.front().time);
    if (ImGui::SliderFloat("seconds", &seconds, 0.5f, 120, "%.1f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
      retimeToLast(route, double(seconds));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("From the first key to the last, at one speed");
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
