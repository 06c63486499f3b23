// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "viewer/panels.h"

namespace ibr::app {

void showView(PanelInput& input) {
  Viewer& viewer = input.viewer;
  Place& place = *viewer.place();
  const glm::dvec3 p = place.walk.pose.position, forward = place.walk.pose.rotation * glm::dvec3(0, 0, -1);
  ImGui::Text("at      %.3f  %.3f  %.3f", p.x, p.y, p.z);
  ImGui::Text("looking %.3f  %.3f  %.3f", forward.x, forward.y, forward.z);
  float degrees = float(glm::degrees(place.walk.fovY));
  if (ImGui::SliderFloat("field of view", &degrees, 10, 120, "%.0f degrees high")) {
    place.walk.fovY = glm::radians(double(degrees));
    place.changed = true;
  }
  float speed = float(place.walk.speed / place.step);
  if (ImGui::SliderFloat("speed", &speed, 0.05f, 50, "%.2f photographs/s", ImGuiSliderFlags_Logarithmic))
    place.walk.speed = double(speed) * place.step;
  ImGui::Checkbox("stay near the photographs", &place.bounded);
  const double away = distanceTo(place.bounds, p) / place.bounds.radius;
  ImGui::SameLine();
  ImGui::TextColored(away <= 1 ? ImVec4(0.13f, 0.57f, 0.55f, 1) : ImVec4(0.99f, 0.91f, 0.14f, 1), "%s",
                     away <= 1 ? "near them" : fmt::format("{:.1f} steps beyond them", away - 1).c_str());
  if (ImGui::Button("screenshot")) viewer.wantsScreenshot = true;
  ImGui::SameLine();
  if (ImGui::Button("keys (F1)")) viewer.showHelp = !viewer.showHelp;

  ImGui::Separator();
  ImGui::Text("%zu photographs", place.viewpoints.size());
  if (ImGui::BeginChild("photographs")) {
    ImGuiListClipper clipper;
    clipper.Begin(int(place.viewpoints.size()));
    while (clipper.Step())
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
        const Viewpoint& v = place.viewpoints[std::size_t(i)];
        const double off = glm::distance(v.camera.pose.position, p);
        ImGui::PushID(i);
        if (ImGui::Selectable(fmt::format("{}   {:.2f} away", v.name, off).c_str(), off == 0))
          place.flyToViewpoint(std::size_t(i));
        ImGui::PopID();
      }
  }
  ImGui::EndChild();
}

}  // namespace ibr::app
