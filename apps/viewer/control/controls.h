// SPDX-License-Identifier: Apache-2.0
// Keys and the mouse, put into the camera of the place that is shown.
#pragma once

#include <span>

#include "viewer/control/viewer.h"
#include "window/window.h"

namespace ibr::app {

/// Between ImGui's new frame and the picture. `seconds` since the frame before. Says whether the picture changes.
bool control(Viewer& viewer, OpenItem& place, double seconds);

/// Between ImGui's new frame and `control`: what each key that was pressed means. While text is typed, or a panel has
/// the keyboard, most are its.
void press(Viewer& viewer, std::span<const KeyPress> keys);

/// A line for each key, for the help.
struct KeyHelp {
  const char* keys;
  const char* what;
};
std::span<const KeyHelp> keyHelp();

}  // namespace ibr::app
