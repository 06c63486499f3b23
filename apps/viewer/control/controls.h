// SPDX-License-Identifier: Apache-2.0
// Maps keys and mouse to the camera of the scene that is shown.
#pragma once

#include <span>

#include "viewer/control/viewer.h"
#include "window/frame_keys.h"
#include "window/window.h"

namespace ibr::app {

/// Call after ImGui::NewFrame, before rendering. `keys`: those that are down in the frame; `seconds`: since the
/// previous frame. Returns true if the view changes.
bool control(Viewer& viewer, OpenItem& item, const FrameKeys& keys, double seconds);

/// Handles pressed keys; `down`: those that are down in the frame. Call between ImGui::NewFrame and `control`. While
/// text is typed or a panel has keyboard focus, most keys are left to ImGui.
void press(Viewer& viewer, std::span<const KeyPress> keys, const FrameKeys& down);

/// Help text of a key.
struct KeyHelp {
  const char* keys;
  const char* what;
};
std::span<const KeyHelp> keyHelp();

}  // namespace ibr::app
