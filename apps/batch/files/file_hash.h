// SPDX-License-Identifier: Apache-2.0
// Keys of what commands keep: files count by name, size and time, not by their bytes.
#pragma once

#include <filesystem>

#include "base/hash.h"

namespace ibr::app {

/// A missing file counts as one of no size.
void addFile(Hash& hash, const std::filesystem::path& file);

/// All regular files below, in the order of their names; or the file.
void addFolder(Hash& hash, const std::filesystem::path& folder);

/// The program that runs.
void addProgram(Hash& hash);

}  // namespace ibr::app
