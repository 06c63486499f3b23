// SPDX-License-Identifier: Apache-2.0
// Integer reference implementation of the colour tables: images of cells → histograms → tables, and their adaptation.
#pragma once

#include <array>
#include <vector>

#include "ibr/image.h"
#include "render/plan/colour_table.h"

namespace ibr::reference {

/// Tables of one cell: red, green, blue.
using CellTable = std::array<LevelTable, 3>;

struct MappedCells {
  std::vector<Image8> picture;  // one image a cell, best first, RGBA; alpha 0 outside the cell
  std::vector<std::uint16_t> noise;
  std::uint32_t kept = 0;  // ranks below `kept` are counted
  std::uint32_t method = shader::kMapPreserving, least = 256;
};

struct CellHistograms {
  std::array<LevelHistogram, 3> reference{}, modify{};
};

/// Histograms of the sequence in [T]: the framebuffer holds all better cells, mapped through their tables in `shown`.
CellHistograms histograms(const MappedCells& cells, std::size_t k, const std::vector<CellTable>& shown);

/// Tables of all cells, main cell first, without adaptation over time.
std::vector<CellTable> tables(const MappedCells& cells);

}  // namespace ibr::reference
