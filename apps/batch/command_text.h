// SPDX-License-Identifier: Apache-2.0
// Command lines that can be typed again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ibr::app {

/// Returns `command` ("ibr-lab sweep") with its words, quoted for a shell.
std::string commandText(const std::string& command, const std::vector<std::string>& words);

/// True if `folder` is `of` or lies below `of`, after resolving links. The folders need not exist.
bool isInside(const std::filesystem::path& folder, const std::filesystem::path& of);

}  // namespace ibr::app
