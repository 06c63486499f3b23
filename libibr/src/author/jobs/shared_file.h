// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ibr/scene.h"

namespace ibr {

/// Makes `to` another name of the file `from` (a hard link), or where the file system has no such links a copy of it.
/// Folders are made; what stood at `to` is replaced at once, never half. Files here are replaced when they are written
/// anew (writeFile), so that what has two names stays as it is. Throws Error{io} that names the file.
void shareFile(const std::filesystem::path& from, const std::filesystem::path& to);

/// Writes a scene to another folder than its own; its photographs and textures there are shared files. Throws Error.
void shareScene(const Scene& scene, const std::filesystem::path& folder);

}  // namespace ibr
