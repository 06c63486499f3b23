// SPDX-License-Identifier: Apache-2.0
// Panels over the image, one file each. A panel reads and changes the Viewer's state; no panel uses a device.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viewer/control/memory_budget.h"
#include "viewer/control/viewer.h"
#include "viewer/open/item_on_device.h"
#include "window/window.h"

namespace ibr::app {

struct PanelInput {
  Viewer& viewer;
  Window& window;
  std::string device;
  DeviceKind deviceKind;
  const FramePlan* plan = nullptr;  // of the previous frame; nullptr for harmonised models and during an upload
  std::vector<MemoryClass> memory = {};
  std::uint64_t sceneBudget = 0;  // --vram-budget; 0: none
  MemoryBudget budget = {};
  std::optional<GpuScene::StreamStatus> streamed = {};
  bool uploading = false;  // the current item is not on the device yet
};

/// Draws the whole interface. Call within an ImGui frame.
void showAll(PanelInput& input);

// Pages of the side panel.
void showView(PanelInput& input);
void showSettings(PanelInput& input);
void showCells(PanelInput& input);
void showMap(PanelInput& input);
void showPresets(PanelInput& input);  // above the settings
void showCameraPath(PanelInput& input);
void showTimes(PanelInput& input);
void showMemory(PanelInput& input);
void showLog(PanelInput& input);

/// Call after a panel has changed the settings of a scene: requests a redraw and clears the outdated measurement.
void settingsChanged(OpenItem& item);

// Windows over the image.
void showHelp(PanelInput& input);
void showWelcome(PanelInput& input);  // while nothing is open
void showOpen(PanelInput& input);     // while Viewer::showOpenDialog
void showMessage(PanelInput& input);
void showTimeLine(PanelInput& input);  // 3D video
void showLegend(PanelInput& input);    // while an overlay is on

/// Begins a window without decoration, sized to its contents; end it with ImGui::End.
void beginCard(const char* name, ImVec2 at, ImVec2 pivot, ImGuiWindowFlags keys = ImGuiWindowFlags_NoNav);
/// Draws a square of a display-encoded colour, with a side of one font size.
void swatch(glm::vec3 colour);

}  // namespace ibr::app
