// SPDX-License-Identifier: Apache-2.0
// X11 operations that xdotool lacks: reading a window's pixels, waiting for frames (_NET_WM_PING), drops (XDND).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr::test {

/// Pixels of a window, RGB. Empty while the window cannot be read, for example during a resize. `window`: the number
/// from xdotool.
Image8 pixelsOf(const std::string& window);

/// Waits until the window's program has processed its event queue `times` times, this call's own message included: once
/// for earlier input, and once more for each frame drawn afterwards. Throws std::runtime_error after two minutes
/// without an answer.
void waitForFrames(const std::string& window, int times);

/// Drags files and folders into the middle of a window and drops them, as file managers do. Throws std::runtime_error
/// if the window does not accept the drop within ten seconds.
void dropOnto(const std::string& window, const std::vector<std::filesystem::path>& paths);

/// Sets the monitor resolution (dots an inch) for programs started during its lifetime. Otherwise 96.
class MonitorDpi {
 public:
  explicit MonitorDpi(int dotsPerInch);
  ~MonitorDpi();
  MonitorDpi(const MonitorDpi&) = delete;
  MonitorDpi& operator=(const MonitorDpi&) = delete;
};

}  // namespace ibr::test
