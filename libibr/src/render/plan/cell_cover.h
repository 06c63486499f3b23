// SPDX-License-Identifier: Apache-2.0
// Computes which parts of a frame each cell shows, and chooses the cells that cover most. Pure.
#pragma once

#include <bitset>
#include <cstddef>
#include <functional>
#include <memory_resource>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

inline constexpr std::size_t kCoverColumns = 8, kCoverRows = 6;  // tiles of a view
inline constexpr std::size_t kCoverTiles = 2 * kCoverColumns * kCoverRows;

using CellCover = std::bitset<kCoverTiles>;  // tiles of both views that show the cell's tier 0

/// Returns the tiles in which a point of CellBounds::surface is seen, as a static point; a tile between two points may
/// be missed. `origin`: position of the cell's first photograph, world, which the points are relative to.
CellCover coverOf(const CellBounds& cell, glm::dvec3 origin, std::span<const Camera> views);

/// Chooses at most `most` cells, which together cover the views best. Maximises greedily
///
///   F(S) = Σ over tiles of the largest worth of a chosen cell that shows the tile.
///
/// A tile without a cell is worth `behind`, >= 0. With 0, cells that add nothing are chosen in the given order; with
/// more, the choice stops when nothing is gained. `worth`: of each cell, > 0. `forced`: index of a cell that is chosen
/// in any case; the number of cells: none. `coverOf`: computes the cover of a cell, a part of `tiles`; called at most
/// once a cell, and not for cells that cannot be chosen. Returns indices, ascending.
std::pmr::vector<std::size_t> coveringCells(const std::function<CellCover(std::size_t)>& coverOf,
                                            const CellCover& tiles, std::span<const double> worth, double behind,
                                            std::size_t most, std::size_t forced,
                                            std::pmr::memory_resource* memory = std::pmr::get_default_resource());

/// All tiles of one or two views.
CellCover tilesOfViews(std::size_t views);

}  // namespace ibr
