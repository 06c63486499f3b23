// SPDX-License-Identifier: Apache-2.0
#include "window/interface.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>
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

void Interface::beginFrame() {
  ImGui_ImplGlfw_NewFrame();
  keys_.beginFrame(window_.takeKeyChanges());
#if IMGUI_VERSION_NUM < 18700
  // This version samples key states once per frame. Later ones queue the changes themselves.
  ImGuiIO& io = ImGui::GetIO();
  for (int key = 0; key < IM_ARRAYSIZE(io.KeysDown); ++key) io.KeysDown[key] = keys_.isDown(key);
  io.KeyCtrl = keys_.isDown(GLFW_KEY_LEFT_CONTROL) || keys_.isDown(GLFW_KEY_RIGHT_CONTROL);
  io.KeyShift = keys_.isDown(GLFW_KEY_LEFT_SHIFT) || keys_.isDown(GLFW_KEY_RIGHT_SHIFT);
  io.KeyAlt = keys_.isDown(GLFW_KEY_LEFT_ALT) || keys_.isDown(GLFW_KEY_RIGHT_ALT);
#endif
  ImGui::NewFrame();
}

bool Interface::hasPendingKeys() const noexcept {
#if IMGUI_VERSION_NUM >= 18700
  if (!ImGui::GetCurrentContext()->InputEventsQueue.empty()) return true;
#endif
  return keys_.hasPending();
}

}  // namespace ibr::app
