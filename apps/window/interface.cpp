// SPDX-License-Identifier: Apache-2.0
#include "window/interface.h"

#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <cmath>
#include <utility>

namespace fs = std::filesystem;

namespace ibr::app {

Interface::Interface(const Window& window, const fs::path& layout) : layout_(layout.string()), window_(window) {
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
  // ImGui counts in the window's units, which may be larger than pixels.
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
  ImGui::NewFrame();
}

}  // namespace ibr::app
