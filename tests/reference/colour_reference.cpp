// SPDX-License-Identifier: Apache-2.0
#include "reference/colour_reference.h"

#include "shared/cell.h"

namespace ibr::reference {

CellHistograms histograms(const MappedCells& cells, std::size_t k, const std::vector<CellTable>& shown) {
  CellHistograms result;
  const Image8& own = cells.picture[k];
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x) {
      if (cells.noise[std::size_t(y % shader::kNoiseSize * shader::kNoiseSize + x % shader::kNoiseSize)] >= cells.kept)
        continue;
      if (own.pixel(x, y)[3] == 0) continue;
      std::size_t owner = 0;
      while (owner < k && cells.picture[owner].pixel(x, y)[3] == 0) ++owner;
      if (owner == k) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        ++result.modify[c][own.pixel(x, y)[c]];
        ++result.reference[c][shown[owner][c][cells.picture[owner].pixel(x, y)[c]]];
      }
    }
  return result;
}

std::vector<CellTable> tables(const MappedCells& cells) {
  std::vector<CellTable> all;
  for (std::size_t k = 0; k < cells.picture.size(); ++k) {
    CellTable table;
    table.fill(identityTable());
    if (k > 0) {
      const CellHistograms h = histograms(cells, k, all);
      for (std::size_t c = 0; c < 3; ++c) table[c] = levelTable(h.reference[c], h.modify[c], cells.method, cells.least);
    }
    all.push_back(table);
  }
  return all;
}

}  // namespace ibr::reference
