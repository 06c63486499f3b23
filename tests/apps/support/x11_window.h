// SPDX-License-Identifier: Apache-2.0
// What xdotool cannot: a window's pixels, its frames (by the protocol _NET_WM_PING), and things dropped onto it (XDND).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr::test {

/// What a window shows, RGB; nothing while it cannot be read, as when it changes its size. `window` is its number, as
/// xdotool has it.
Image8 pixelsOf(const std::string& window);

/// Waits until the window's program has gone `times` times through what has come to it, this call's own question last:
/// once for what was typed before, and once more for each frame that has been drawn since. Throws std::runtime_error
/// where no answer comes within two minutes.
void waitForFrames(const std::string& window, int times);

/// Drags files and folders into the middle of a window and lets go, as file managers do. Throws std::runtime_error
/// where the window does not take them within ten seconds.
void dropOnto(const std::string& window, const std::vector<std::filesystem::path>& paths);

/// Programs that are started while this lives take the monitor to have so many dots an inch; 96 before and after.
class MonitorDpi {
 public:
  explicit MonitorDpi(int dotsPerInch);
  ~MonitorDpi();
  MonitorDpi(const MonitorDpi&) = delete;
  MonitorDpi& operator=(const MonitorDpi&) = delete;
};

}  // namespace ibr::test
