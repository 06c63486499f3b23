// SPDX-License-Identifier: Apache-2.0
// Folders that a person types.
#pragma once

#include <filesystem>
#include <string>

namespace ibr::app {

/// White space at the ends is not meant; ~ at the beginning is the home folder.
std::filesystem::path typedPath(const std::string& text);

/// `text` with as much added as all folders go on with that begin so; the only one gets a slash. Hidden ones count
/// where a dot has been typed. The same text where there is none.
std::string completedFolder(const std::string& text);

}  // namespace ibr::app
