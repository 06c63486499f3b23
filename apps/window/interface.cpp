// SPDX-License-Identifier: Apache-2.0
#include "window/interface.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <cmath>
#include <set>
#include <utility>

namespace fs = std::filesystem;

namespace ibr::app {

Interface::Interface(Window& window, const fs::path& layout) : layout_(layout.string()), window_(window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = layout_.empty() ? nullptr : layout_.c_str();
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
}

bool Interface::setScale(float scale) {
  if (std::exchange(scale_, scale) == scale) return false;
  // ImGui measures in window units; one unit may be more than one pixel.
  const float unit = window_.pixelsPerUnit();
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowRounding = 4;
  style.FrameRounding = 3;
  style.Colors[ImGuiCol_WindowBg].w = 0.85f;
  style.ScaleAllSizes(scale / unit);
  ImGui::GetStyle() = style;
  ImGuiIO& io = ImGui::GetIO();
  ImFontConfig font;
  font.SizePixels = std::round(13 * scale);
  io.Fonts->Clear();
  io.Fonts->AddFontDefault(&font);
  io.FontGlobalScale = 1 / unit;
  return true;
}

Interface::~Interface() {
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

// ImGui 1.86 samples key states once per frame. On a slow device most keys go down and up between two frames and would
// be missed. Each frame therefore applies the changes in order, at most one per key.
void Interface::applyKeyChanges() {
  ImGuiIO& io = ImGui::GetIO();
  for (const KeyChange& change : window_.takeKeyChanges())
    if (change.key >= 0 && change.key < IM_ARRAYSIZE(io.KeysDown)) keyChanges_.push_back(change);
  std::set<int> waiting;
  for (const KeyChange& change : keyChanges_)
    if (waiting.insert(change.key).second) io.KeysDown[change.key] = !change.down;  // the state in the previous frame
  for (; !keyChanges_.empty() && waiting.erase(keyChanges_.front().key) > 0; keyChanges_.pop_front())
    io.KeysDown[keyChanges_.front().key] = keyChanges_.front().down;
  io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
  io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
  io.KeyAlt = io.KeysDown[GLFW_KEY_LEFT_ALT] || io.KeysDown[GLFW_KEY_RIGHT_ALT];
}

void Interface::beginFrame() {
  ImGui_ImplGlfw_NewFrame();
  applyKeyChanges();
  ImGui::NewFrame();
}

}  // namespace ibr::app
