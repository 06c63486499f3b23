// SPDX-License-Identifier: Apache-2.0
// Finished cells of an unfinished optimisation, one file each, named by a hash of all that the cell depends on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "author/align/align_cell.h"

namespace ibr {

/// Of the cell's mesh, cameras and pictures, and of the options but for what is set for each cell.
std::uint64_t alignmentKey(const CellToAlign& input, const AlignmentOptions& options);

void storeAligned(const std::filesystem::path& folder, std::uint64_t key, const AlignedCell& cell);

/// nullopt where there is none, or one that is damaged.
std::optional<AlignedCell> fetchAligned(const std::filesystem::path& folder, std::uint64_t key);

}  // namespace ibr
