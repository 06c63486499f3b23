// SPDX-License-Identifier: Apache-2.0
// The user's folders, as the XDG base and user directories say.
#pragma once

#include <filesystem>
#include <string>

namespace ibr::app {

/// For what programs keep: libibr in $XDG_CONFIG_HOME or ~/.config, for what could be made again in $XDG_CACHE_HOME or
/// ~/.cache; made where they are missing. Empty where that cannot be.
std::filesystem::path settingsFolder();
std::filesystem::path cacheFolder();

/// Where what a person makes goes: ibr in the folder for pictures that user-dirs.dirs names, or in ~/Pictures; the
/// current folder where neither is there. Not made.
std::filesystem::path picturesFolder();

/// What people call a folder or file: its own name, also where the path ends in a slash or is ".".
std::string folderName(const std::filesystem::path& path);

}  // namespace ibr::app
