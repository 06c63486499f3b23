// SPDX-License-Identifier: Apache-2.0
// The user's folders by the XDG base directory and user directory specifications.
#pragma once

#include <filesystem>
#include <string>

namespace ibr::app {

/// Returns libibr's folder for settings, in $XDG_CONFIG_HOME or ~/.config, and for its cache, in $XDG_CACHE_HOME or
/// ~/.cache. A missing folder is created. Empty: the folder cannot be created.
std::filesystem::path settingsFolder();
std::filesystem::path cacheFolder();

/// Returns the folder for the user's output: ibr in the pictures folder of user-dirs.dirs, or in ~/Pictures; the
/// current folder if neither exists. The folder is not created.
std::filesystem::path picturesFolder();

/// Returns the name of a folder or file for people, also if the path ends in a slash or is ".".
std::string folderName(const std::filesystem::path& path);

}  // namespace ibr::app
