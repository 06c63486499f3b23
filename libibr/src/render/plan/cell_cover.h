// SPDX-License-Identifier: Apache-2.0
// Which parts of a frame a cell shows. Pure.
#pragma once

#include <bitset>
#include <cstddef>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

inline constexpr std::size_t kCoverColumns = 8, kCoverRows = 6;  // tiles of a view
inline constexpr std::size_t kCoverTiles = 2 * kCoverColumns * kCoverRows;

using CellCover = std::bitset<kCoverTiles>;  // tiles of both views that the cell's tier 0 is seen in

/// By CellBounds::surface, as static points: a part between two points may be missed. `place`: of the cell's first
/// photograph, world units.
CellCover coverOf(const CellBounds& cell, glm::dvec3 place, std::span<const Camera> views);

/// Chooses at most `most` cells, which together cover the views best:
///
///   F(S) = Σ over tiles of the largest worth of a chosen cell that is seen in the tile,
///
/// greedily. A tile without a cell is worth `behind`, >= 0: with 0, where nothing more is gained cells are chosen in
/// the given order; else fewer are chosen. `worth`: > 0, of each cell; `forced`: is chosen whatever it covers, or the
/// number of cells. Returns their numbers, ascending. Time goes with cells × most.
std::vector<std::size_t> coveringCells(std::span<const CellCover> covers, std::span<const double> worth, double behind,
                                       std::size_t most, std::size_t forced);

}  // namespace ibr
