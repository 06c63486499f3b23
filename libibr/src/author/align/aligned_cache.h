// SPDX-License-Identifier: Apache-2.0
// Cache of aligned cells, for resuming an optimisation. One file per cell, named by a hash of the cell's inputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "author/align/align_cell.h"

namespace ibr {

/// Hash of the cell's mesh, cameras, images and masks, and of all options except those set for each cell (threads,
/// guard).
std::uint64_t alignmentKey(const CellAlignmentInput& input, const AlignmentOptions& options);

void storeAligned(const std::filesystem::path& folder, std::uint64_t key, const AlignedCell& cell);

/// Returns nullopt if the file is missing or damaged.
std::optional<AlignedCell> fetchAligned(const std::filesystem::path& folder, std::uint64_t key);

}  // namespace ibr
