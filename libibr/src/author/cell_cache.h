// SPDX-License-Identifier: Apache-2.0
// Finished cells of an unfinished build, one file each, named by a hash of all that the cell depends on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "author/mesh.h"
#include "ibr/image.h"

namespace ibr {

void storeCell(const std::filesystem::path& folder, std::uint64_t key, const CellMesh& cell);

/// nullopt where there is none, or one that is damaged.
std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key);

/// Likewise the depths in the members' own photographs (own_depth.h); they come back to 1/65534 of the nearest.
void storeDepths(const std::filesystem::path& folder, std::uint64_t key, const std::vector<ImageF>& depths);
std::optional<std::vector<ImageF>> fetchDepths(const std::filesystem::path& folder, std::uint64_t key);

}  // namespace ibr
