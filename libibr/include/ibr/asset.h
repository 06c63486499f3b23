// SPDX-License-Identifier: Apache-2.0
// What kind of thing a path holds, for programs that open several.
#pragma once

#include <filesystem>
#include <optional>

namespace ibr {

enum class AssetKind { scene, htmModel, htmSequence };

/// By the name of a folder's file, or of a file's content; nullopt where there is neither or it cannot be
/// read. Nothing else is looked at. Never throws.
std::optional<AssetKind> assetKind(const std::filesystem::path& path) noexcept;

}  // namespace ibr
