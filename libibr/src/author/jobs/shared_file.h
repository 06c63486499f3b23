// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ibr/scene.h"

namespace ibr {

/// Makes `to` a hard link to the file `from`, or a copy if the file system has no hard links. Creates folders; replaces
/// an existing `to` atomically. Files here are always replaced when they are written again (writeFile), so neither name
/// sees the other's later change. Throws Error{io} that names the file.
void shareFile(const std::filesystem::path& from, const std::filesystem::path& to);

/// Writes a scene to another folder than its own, sharing its photographs and textures (shareFile). Throws Error.
void shareScene(const Scene& scene, const std::filesystem::path& folder);

}  // namespace ibr
