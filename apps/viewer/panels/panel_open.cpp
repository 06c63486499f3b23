// SPDX-License-Identifier: Apache-2.0
// Text field for a folder to open.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "shared/cli/typed_path.h"
#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

int complete(ImGuiInputTextCallbackData* data) {
  const std::string typed(data->Buf, std::size_t(data->BufTextLen)), whole = completedFolder(typed);
  if (data->CursorPos == data->BufTextLen) data->InsertChars(data->CursorPos, whole.c_str() + typed.size());
  return 0;
}

}  // namespace

void showOpen(PanelInput& input) {
  Viewer& viewer = input.viewer;
  if (!viewer.showOpenDialog) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  beginCard("open", {0.5f * size.x, 0.3f * size.y}, {0.5f, 0.5f}, ImGuiWindowFlags_None);
  if (ImGui::IsWindowAppearing()) viewer.openDialogHasKeyboard = false;
  ImGui::TextUnformatted("Folder of a scene, a harmonised model, 3D video or photographs:");
  ImGui::SetNextItemWidth(std::min(36 * ImGui::GetFontSize(), 0.9f * size.x));
  const bool entered =
      ImGui::InputText("##folder", &viewer.openDialogText,
                       ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion, complete);
  viewer.openDialogHasKeyboard |= ImGui::IsItemActive();
  if (!viewer.openDialogHasKeyboard) ImGui::SetKeyboardFocusHere(-1);  // a request before the field fails in 1.90
  const bool left = ImGui::IsItemDeactivated();
  ImGui::TextDisabled("tab: complete   ctrl V: paste   enter: open   escape: cancel");
  ImGui::End();
  if (!entered && !left) return;
  viewer.showOpenDialog = false;
  ImGui::SetWindowFocus(nullptr);  // gives the keyboard back to the view
  if (const std::filesystem::path folder = typedPath(viewer.openDialogText); entered && !folder.empty())
    viewer.open(folder);
}

}  // namespace ibr::app
