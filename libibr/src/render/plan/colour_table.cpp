// SPDX-License-Identifier: Apache-2.0
#include "render/plan/colour_table.h"

#include <algorithm>
#include <numeric>

namespace ibr {

LevelTable identityTable() {
  LevelTable table;
  std::iota(table.begin(), table.end(), std::uint8_t(0));
  return table;
}

LevelTable levelTable(const LevelHistogram& reference, const LevelHistogram& modify, std::uint32_t method,
                      std::uint32_t least) {
  LevelHistogram r, m;  // r̂, m̂ of eq. 9
  std::partial_sum(reference.begin(), reference.end(), r.begin());
  std::partial_sum(modify.begin(), modify.end(), m.begin());
  const std::uint32_t samples = m.back();
  if (samples == 0) return identityTable();

  const auto naive = [&](int i) {  // eq. 10
    const auto j = std::lower_bound(r.begin(), r.end(), m[std::size_t(i)]);
    return std::min(int(j - r.begin()), shader::kLevels - 1);
  };
  shader::ObservedRange range{};
  range.bottom = int(std::upper_bound(m.begin(), m.end(), 0u) - m.begin());    // eq. 11
  range.top = int(std::lower_bound(m.begin(), m.end(), samples) - m.begin());  // eq. 12
  range.bottomLevel = naive(range.bottom);
  range.topLevel = naive(range.top);

  LevelTable table;
  for (int i = 0; i < shader::kLevels; ++i)
    table[std::size_t(i)] =
        std::uint8_t(shader::trustedLevel(shader::specifiedLevel(range, i, naive(i), method), i, samples, least));
  return table;
}

}  // namespace ibr
