// SPDX-License-Identifier: Apache-2.0
// What xdotool cannot: a window's pixels, and things dropped onto it (X11, by the protocol XDND).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr::test {

/// What a window shows, RGB. `window` is its number, as xdotool has it. Throws std::runtime_error.
Image8 pixelsOf(const std::string& window);

/// Drags files and folders into the middle of a window and lets go, as file managers do. Throws std::runtime_error
/// where the window does not take them within ten seconds.
void dropOnto(const std::string& window, const std::vector<std::filesystem::path>& paths);

}  // namespace ibr::test
