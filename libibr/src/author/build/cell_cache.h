// SPDX-License-Identifier: Apache-2.0
// Cache of cells, for resumed and later builds. One file per cell, named by a hash of all that the cell depends on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "author/mesh/mesh.h"

namespace ibr {

/// Path of a cell's file.
std::filesystem::path cellFile(const std::filesystem::path& folder, std::uint64_t key);

void storeCell(const std::filesystem::path& folder, std::uint64_t key, const CellMesh& cell);

/// Returns nullopt if the file is missing or damaged.
std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key);

}  // namespace ibr
