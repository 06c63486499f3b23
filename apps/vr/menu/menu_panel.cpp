// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/menu_panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <filesystem>

#include "base/check.h"
#include "vr/menu/menu_canvas.h"

namespace ibr::app {
namespace {

bool onPanel(const MenuPointer& pointer) {
  const auto inside = [](double value) { return value >= 0 && value <= 1; };  // false for NaN
  return pointer.at && inside(pointer.at->x) && inside(pointer.at->y);
}

// Uses DejaVu Sans if installed: its strokes are wide enough for a headset, and it covers Latin, Greek and Cyrillic
// names. Else uses ImGui's built-in font.
void addLetters(ImFontAtlas& fonts, float pixels) {
  constexpr std::array kFiles{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                              "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                              "/usr/share/fonts/TTF/DejaVuSans.ttf"};
  static constexpr std::array<ImWchar, 7> kRanges{0x20, 0x17F, 0x370, 0x3FF, 0x400, 0x52F, 0};
  const auto* file = std::ranges::find_if(kFiles, [](const char* name) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(name, ignored);
  });
  ImFontConfig font;
  font.SizePixels = pixels;
  if (file == kFiles.end() || !fonts.AddFontFromFileTTF(*file, pixels, &font, kRanges.data()))
    fonts.AddFontDefault(&font);
  fonts.Build();
}

void drawPointer(float unit) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.MousePos.x < 0) return;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddCircleFilled(io.MousePos, 9 * unit, kMenuBackground, 24);
  list.AddCircleFilled(io.MousePos, 6 * unit, io.MouseDown[0] ? kMenuCurrentSpot : kMenuText, 24);
}

}  // namespace

CurrentContext::CurrentContext(ImGuiContext* context) : previous_(ImGui::GetCurrentContext()) {
  ImGui::SetCurrentContext(context);
}
CurrentContext::~CurrentContext() {
  ImGui::SetCurrentContext(previous_);
}

MenuPanel::MenuPanel(int width, int height) : width_(width), height_(height) {
  check(width >= 64 && height >= 64, ErrorCode::invalidInput, "the menu's panel is only {}×{} px", width, height);
  IMGUI_CHECKVERSION();
  ImGuiContext* before = ImGui::GetCurrentContext();  // CreateContext may make the new context current
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;  // supported by InterfaceDrawer; maps have many vertices
  io.DisplaySize = {float(width), float(height)};
  addLetters(*io.Fonts, float(std::round(kMenuFontShare * height)));
  ImGui::GetStyle().WindowPadding = {0, 0};
  ImGui::GetStyle().WindowBorderSize = 0;
  ImGui::SetCurrentContext(before);
}

MenuPanel::~MenuPanel() {
  ImGui::DestroyContext(context_);
}

void MenuPanel::open() {
  menu_.reset();
  releasedSinceOpen_ = false;
}

void MenuPanel::setPointer(const MenuPointer& pointer) {
  const bool on = onPanel(pointer);
  releasedSinceOpen_ |= !pointer.held;
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = on ? ImVec2(float(pointer.at->x * width_), float(pointer.at->y * height_)) : ImVec2(-FLT_MAX, -FLT_MAX);
  io.MouseDown[0] = pointer.held && releasedSinceOpen_;
}

MenuRequests MenuPanel::show(const MenuModel& model, const MenuPointer& pointer, double seconds) {
  const CurrentContext current(context_);
  setPointer(pointer);
  // ImGui requires a positive time step; the limit keeps a pause from counting as time.
  ImGui::GetIO().DeltaTime = seconds > 1e-4 ? float(std::min(seconds, 0.1)) : 1e-4f;
  ImGui::NewFrame();
  const MenuRequests requests = menu_.show(model, {float(width_), float(height_)});
  drawPointer(float(height_) / 600);
  ImGui::Render();
  return requests;
}

}  // namespace ibr::app
