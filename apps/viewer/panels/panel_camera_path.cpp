// SPDX-License-Identifier: Apache-2.0
// Page "Path": the camera path, key by key.
#include <fmt/format.h>
#include <imgui.h>

#include "shared/camera/path_recorder.h"
#include "viewer/panels/panels.h"

namespace ibr::app {

void showCameraPath(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  CameraPath& cameraPath = item.cameraPath;
  if (ImGui::Button("add key (K)")) item.addPathKey();
  ImGui::SameLine();
  if (ImGui::Button(item.playingPath ? "stop" : "play (J)")) {
    if (item.playingPath)
      item.playingPath = false;
    else
      item.showCameraPath();
  }
  if (ImGui::Button("save (ctrl S)")) input.viewer.savePathRequested = true;
  if (ImGui::Button("video (ctrl M)")) input.viewer.videoRequested = true;
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Rendered in the background, at the window's size, with the current settings");
  ImGui::Checkbox("loop", &item.loopingPath);
  if (cameraPath.keys.empty()) {
    ImGui::TextWrapped(
        "A key stores the current view. The camera follows a spline through the keys. ibr render --poses renders "
        "a saved path exactly as the viewer plays it.");
    return;
  }
  if (cameraPath.keys.size() > 1) {
    float seconds = float(cameraPath.keys.back().time - cameraPath.keys.front().time);
    if (ImGui::SliderFloat("seconds", &seconds, 0.5f, 120, "%.1f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
      retimeToLast(cameraPath, double(seconds));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Duration from the first to the last key, at constant speed");
  }
  if (ImGui::BeginChild("keys"))
    for (std::size_t k = 0; k < cameraPath.keys.size(); ++k) {
      const CameraKey& key = cameraPath.keys[k];
      ImGui::PushID(int(k));
      if (ImGui::SmallButton("x")) {
        deleteKey(cameraPath, k);
        item.playingPath = false;
        ImGui::PopID();
        break;
      }
      ImGui::SameLine();
      if (ImGui::Selectable(
              fmt::format("{:7.2f} s   {:.3f} {:.3f} {:.3f}", key.time, key.position.x, key.position.y, key.position.z)
                  .c_str())) {
        flyTo(item.navigation, {key.position, key.rotation}, key.fovY, 0.6);
        item.changed = true;
      }
      ImGui::PopID();
    }
  ImGui::EndChild();
}

}  // namespace ibr::app
