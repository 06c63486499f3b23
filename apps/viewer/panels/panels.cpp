// SPDX-License-Identifier: Apache-2.0
#include "viewer/panels/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

#include "viewer/control/controls.h"

namespace ibr::app {
namespace {

constexpr const char *kSidePanel = "ibr", *kTimeLine = "time", *kMessage = "message";

struct Tab {
  const char* name;
  void (*show)(PanelInput&);
};
constexpr std::array kTabs{
    Tab{"View", showView},       Tab{"Settings", showSettings}, Tab{"Cells", showCells},   Tab{"Map", showMap},
    Tab{"Path", showCameraPath}, Tab{"Times", showTimes},       Tab{"Memory", showMemory}, Tab{"Log", showLog}};

// Tabs of the open scenes; a scene can be chosen and closed with the mouse alone.
void showItemTabs(PanelInput& input) {
  Viewer& viewer = input.viewer;
  if (!ImGui::BeginTabBar("items", ImGuiTabBarFlags_FittingPolicyScroll)) return;
  std::size_t closed = viewer.items.size();
  for (std::size_t i = 0; i < viewer.items.size(); ++i) {
    ImGui::PushID(int(i));
    bool open = true;
    const auto flags = viewer.activeTab != i && viewer.current == i ? ImGuiTabItemFlags_SetSelected : 0;
    if (ImGui::BeginTabItem(viewer.items[i]->name.c_str(), &open, flags)) {
      if (!(flags & ImGuiTabItemFlags_SetSelected) && viewer.activeTab == viewer.current) viewer.current = i;
      viewer.activeTab = i;
      ImGui::EndTabItem();
    }
    if (!open) closed = i;
    ImGui::PopID();
  }
  ImGui::EndTabBar();
  if (closed < viewer.items.size()) {
    viewer.current = closed;
    viewer.closeCurrent();
  }
}

// Draws buttons instead of ImGui's tab bar: they wrap, so that all names are visible at any width.
void chooseTab(std::size_t& shown) {
  const float right = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  const ImGuiStyle& style = ImGui::GetStyle();
  for (std::size_t i = 0; i < kTabs.size(); ++i) {
    const float width = ImGui::CalcTextSize(kTabs[i].name).x + 2 * style.FramePadding.x;
    if (i > 0 && ImGui::GetItemRectMax().x + style.ItemInnerSpacing.x + width <= right)
      ImGui::SameLine(0, style.ItemInnerSpacing.x);
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(i == shown ? ImGuiCol_TabActive : ImGuiCol_Tab));
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImGui::GetStyleColorVec4(ImGuiCol_TabHovered));
    if (ImGui::Button(kTabs[i].name)) shown = i;
    ImGui::PopStyleColor(2);
    if (i == shown) ImGui::SetItemDefaultFocus();  // the start of keyboard navigation
  }
  ImGui::Separator();
}

// F6 moves the keyboard focus through the panels. A mouse click outside the focused panel ends the focus.
void moveKeyboardFocus(Viewer& viewer) {
  std::vector<const char*> panels;
  if (viewer.item()) panels.push_back(kSidePanel);
  if (viewer.item() && viewer.item()->video) panels.push_back(kTimeLine);
  if (!viewer.jobs.empty()) panels.push_back(kMessage);
  const bool focused = ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow);
  if (std::exchange(viewer.focusNextPanel, false)) {
    const bool inside = focused && (viewer.panelFocused || ImGui::GetIO().NavVisible);
    viewer.focusedPanel = inside ? viewer.focusedPanel + 1 : 0;
    viewer.panelFocused = viewer.focusedPanel < panels.size();
    ImGui::SetWindowFocus(viewer.panelFocused ? panels[viewer.focusedPanel] : nullptr);
  }
  if (ImGui::GetFrameCount() <= 3) ImGui::SetWindowFocus(nullptr);  // ImGui starts with some panel focused
  if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow) || ImGui::IsAnyMouseDown()) viewer.panelFocused = false;
}

// Keeps the panel's distance to the window's right edge when the window is resized, and keeps the panel inside.
void fitPanelToWindow(glm::vec2& layoutWindowSize) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const glm::vec2 before = std::exchange(layoutWindowSize, {size.x, size.y});
  if (before == layoutWindowSize || before.x == 0) return;
  const ImVec2 panel{std::min(ImGui::GetWindowWidth(), size.x), std::min(ImGui::GetWindowHeight(), size.y)};
  const ImVec2 at = ImGui::GetWindowPos();
  ImGui::SetWindowSize(panel);
  ImGui::SetWindowPos(
      {std::clamp(at.x + size.x - before.x, 0.0f, size.x - panel.x), std::clamp(at.y, 0.0f, size.y - panel.y)});
}

void showSidePanel(PanelInput& input) {
  Viewer& viewer = input.viewer;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float width = std::min(26 * ImGui::GetFontSize(), 0.5f * size.x);
  const ImGuiCond when =
      std::exchange(viewer.resetLayout, false) && viewer.frames > 1 ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
  ImGui::SetNextWindowPos({size.x - width - 10, 10}, when);
  ImGui::SetNextWindowSize({width, std::min(0.75f * size.y, 44 * ImGui::GetFontSize())}, when);
  if (ImGui::Begin(kSidePanel, nullptr, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoFocusOnAppearing)) {
    fitPanelToWindow(viewer.layoutWindowSize);
    const OpenItem* item = viewer.item();
    showItemTabs(input);
    if (viewer.item() != item) {  // the input still describes the scene of the previous frame
      input.plan = nullptr;
      input.memory.clear();
      input.streamed.reset();
    } else {
      viewer.activePage = std::min(viewer.activePage, kTabs.size() - 1);
      chooseTab(viewer.activePage);
      ImGui::PushID(int(viewer.activePage));
      kTabs[viewer.activePage].show(input);
      ImGui::PopID();
    }
  }
  ImGui::End();
}

}  // namespace

void beginCard(const char* name, ImVec2 at, ImVec2 pivot, ImGuiWindowFlags keys) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::Begin(name, nullptr,
               keys | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoMove);
}

void showAll(PanelInput& input) {
  Viewer& viewer = input.viewer;
  moveKeyboardFocus(viewer);
  if (viewer.showInterface) {
    if (viewer.item()) {
      showSidePanel(input);
      if (viewer.item() && viewer.item()->video) showTimeLine(input);
      showLegend(input);
    } else {
      showWelcome(input);
    }
  }
  if (viewer.showHelp) showHelp(input);
  showOpen(input);
  if (viewer.showInterface || viewer.messageIsWarning || !viewer.opening.empty() || input.uploading ||
      !viewer.jobs.empty() || !viewer.shaderErrors.empty())
    showMessage(input);
}

void showHelp(PanelInput& input) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  beginCard("help", {0.5f * size.x, 0.5f * size.y}, {0.5f, 0.5f});
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const KeyHelp& line : keyHelp()) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextColored({0.95f, 0.8f, 0.35f, 1}, "%s", line.keys);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.what);
    }
    ImGui::EndTable();
  }
  ImGui::Spacing();
  ImGui::TextDisabled("%s", input.device.c_str());
  ImGui::End();
}

void showWelcome(PanelInput& input) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  beginCard("welcome", {0.5f * size.x, 0.5f * size.y}, {0.5f, 0.5f});
  ImGui::PushTextWrapPos(std::min(0.9f * size.x, 42 * ImGui::GetFontSize()));
  ImGui::TextUnformatted("Drop a folder here, or type its path (ctrl O):");
  for (const char* kind : {"overlapping photographs of one site: a scene is built from them", "a scene of ibr build",
                           "a harmonised model of ibr htm build, or a 3D video of ibr htm sequence"}) {
    ImGui::Bullet();
    ImGui::TextUnformatted(kind);
  }
  ImGui::Spacing();
  ImGui::TextDisabled("F1: keys     %s", input.device.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void showMessage(PanelInput& input) {
  Viewer& viewer = input.viewer;
  const bool still = viewer.messageUntil > std::chrono::steady_clock::now();
  if (!still) viewer.message.clear();
  if (!still && viewer.opening.empty() && !input.uploading && viewer.jobs.empty() && viewer.shaderErrors.empty())
    return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const bool aboveTimeLine = viewer.showInterface && viewer.item() && viewer.item()->video;
  beginCard(kMessage, {0.5f * size.x, size.y - (aboveTimeLine ? 5 * ImGui::GetFontSize() : 16)}, {0.5f, 1},
            viewer.jobs.empty() ? ImGuiWindowFlags_NoNav : ImGuiWindowFlags_None);
  const char spinner = "|/-\\"[int(ImGui::GetTime() * 6) & 3];
  for (const Opening& opening : viewer.opening) ImGui::Text("%c  opening %s", spinner, opening.path.string().c_str());
  if (input.uploading && viewer.item()) ImGui::Text("%c  uploading %s", spinner, viewer.item()->name.c_str());
  for (const auto& [file, text] : viewer.shaderErrors)
    ImGui::TextColored({0.95f, 0.7f, 0.3f, 1}, "%s\n%s", file.c_str(), text.c_str());
  for (const auto& job : viewer.jobs) {
    ImGui::PushID(job.get());
    if (ImGui::SmallButton("stop")) job->cancel();
    ImGui::SameLine();
    ImGui::Text("making %s: %s", job->plan().name.c_str(), job->progress().c_str());
    ImGui::PopID();
  }
  if (still) {
    ImGui::PushTextWrapPos(0.8f * size.x);
    ImGui::TextUnformatted(viewer.message.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

void showTimeLine(PanelInput& input) {
  OpenItem& item = *input.viewer.item();
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.1f * size.x, size.y - 4.5f * ImGui::GetFontSize()}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({0.55f * size.x, 0}, ImGuiCond_FirstUseEver);
  if (ImGui::Begin(kTimeLine, nullptr,
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoFocusOnAppearing)) {
    if (ImGui::Button(item.playing ? "pause" : "play ")) item.playing = !item.playing;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    float seconds = float(item.time);
    const float whole = float(item.video->duration());
    if (ImGui::SliderFloat("##time", &seconds, 0, whole,
                           fmt::format("%.2f s of {:.2f}, frame {}", whole, item.video->frameAt(item.time)).c_str())) {
      item.time = double(seconds);
      item.playing = false;
      item.changed = true;
    }
  }
  ImGui::End();
}

}  // namespace ibr::app
