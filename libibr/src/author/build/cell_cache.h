// SPDX-License-Identifier: Apache-2.0
// Finished cells of an unfinished build, one file each, named by a hash of all that the cell depends on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "author/mesh/mesh.h"

namespace ibr {

void storeCell(const std::filesystem::path& folder, std::uint64_t key, const CellMesh& cell);

/// nullopt where there is none, or one that is damaged.
std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key);

}  // namespace ibr
