// SPDX-License-Identifier: Apache-2.0
// Keys of cached results. Files enter by name, size and time, not by content.
#pragma once

#include <filesystem>

#include "base/hash.h"

namespace ibr::app {

/// Adds a file; a missing one counts as a file of size 0.
void addFile(Hash& hash, const std::filesystem::path& file);

/// Adds all regular files below a folder, sorted by name; or a single file.
void addFolder(Hash& hash, const std::filesystem::path& folder);

/// Adds the running program.
void addProgram(Hash& hash);

}  // namespace ibr::app
