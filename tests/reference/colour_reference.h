// SPDX-License-Identifier: Apache-2.0
// Integer twin of the colour tables' chain: pictures of cells → histograms → tables, and tables from frame to frame.
#pragma once

#include <array>
#include <vector>

#include "ibr/image.h"
#include "render/plan/colour_table.h"

namespace ibr::reference {

/// Of a cell: red, green, blue.
using CellTable = std::array<LevelTable, 3>;

struct MappedCells {
  std::vector<Image8> picture;  // a cell each, best first, RGBA; alpha 0 where the cell is not
  std::vector<std::uint16_t> noise;
  std::uint32_t kept = 0;  // ranks below it are counted
  std::uint32_t method = shader::kMapPreserving, least = 256;
};

struct CellHistograms {
  std::array<LevelHistogram, 3> reference{}, modify{};
};

/// What T's sequence finds: the framebuffer holds every better cell's colours through its table of `shown`.
CellHistograms histograms(const MappedCells& cells, std::size_t k, const std::vector<CellTable>& shown);

/// Tables of all cells, main first, each shown at once.
std::vector<CellTable> tables(const MappedCells& cells);

}  // namespace ibr::reference
