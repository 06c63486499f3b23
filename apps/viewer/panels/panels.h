// SPDX-License-Identifier: Apache-2.0
// What lies over the picture, a file a panel. Each shows and changes what the viewer knows; none touches a device.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viewer/control/memory_budget.h"
#include "viewer/control/viewer.h"
#include "viewer/open/place_on_device.h"
#include "window/window.h"

namespace ibr::app {

struct PanelInput {
  Viewer& viewer;
  Window& window;
  std::string device;
  DeviceKind deviceKind;
  const FramePlan* plan = nullptr;  // of the frame before; none for harmonised models
  std::vector<MemoryClass> memory = {};
  std::uint64_t sceneBudget = 0;  // --vram-budget; 0: none
  MemoryBudget budget = {};
  std::optional<GpuScene::Streamed> streamed = {};
};

/// Everything, in a frame of ImGui.
void showAll(PanelInput& input);

// Tabs of the side panel.
void showView(PanelInput& input);
void showSettings(PanelInput& input);
void showCells(PanelInput& input);
void showMap(PanelInput& input);
void showPresets(PanelInput& input);  // above the settings
void showRoute(PanelInput& input);
void showTimes(PanelInput& input);
void showMemory(PanelInput& input);
void showLog(PanelInput& input);

/// A panel has changed the settings of a place.
void settingsChanged(OpenItem& place);

// Over the picture itself.
void showHelp(PanelInput& input);
void showWelcome(PanelInput& input);  // nothing is open
void showOpen(PanelInput& input);     // while a folder is asked for
void showMessage(PanelInput& input);
void showTimeLine(PanelInput& input);  // 3D video
void showLegend(PanelInput& input);    // while there is an overlay

/// A window that only says something; ImGui::End ends it.
void beginCard(const char* name, ImVec2 at, ImVec2 pivot, ImGuiWindowFlags keys = ImGuiWindowFlags_NoNav);
/// A square of a display-encoded colour, as large as a letter.
void swatch(glm::vec3 colour);

}  // namespace ibr::app
