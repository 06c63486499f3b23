// SPDX-License-Identifier: Apache-2.0
// A command line that can be typed again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ibr::app {

/// `command` ("ibr sweep") and its words as they would be typed in a shell.
std::string commandText(const std::string& command, const std::vector<std::string>& words);

/// Whether `folder` is `of` or lies below it, wherever links lead. Neither need be there.
bool isInside(const std::filesystem::path& folder, const std::filesystem::path& of);

}  // namespace ibr::app
