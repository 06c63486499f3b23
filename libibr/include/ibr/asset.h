// SPDX-License-Identifier: Apache-2.0
// Detects the kind of asset at a path, for programs that open several kinds.
#pragma once

#include <filesystem>
#include <optional>

#include "ibr/export.h"

namespace ibr {

/// Kind of asset that a program can open.
enum class AssetKind {
  scene,       // scene.gltf, for loadScene()
  htmModel,    // model.gltf, for loadHtmModel()
  htmSequence  // sequence.json, for loadHtmSequence()
};

/// Returns a folder's kind by the name of the file in it, and a file's kind by its JSON content. nullopt: no such kind,
/// or not readable. Opens no other files.
IBR_API std::optional<AssetKind> assetKind(const std::filesystem::path& path) noexcept;

}  // namespace ibr
