// SPDX-License-Identifier: Apache-2.0
// Paths of folders that a user types.
#pragma once

#include <filesystem>
#include <string>

namespace ibr::app {

/// Removes white space at both ends, and replaces ~ at the beginning by the home folder.
std::filesystem::path typedPath(const std::string& text);

/// Extends `text` by the longest common continuation of all folders that begin with `text`; a single match also gets a
/// slash. Hidden folders match only if a dot was typed. Without a match the text is returned unchanged.
std::string completedFolder(const std::string& text);

}  // namespace ibr::app
