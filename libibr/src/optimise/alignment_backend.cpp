// SPDX-License-Identifier: Apache-2.0
#include "optimise/alignment_backend.h"

namespace ibr {

std::vector<glm::ivec2> matchOf(const Positions& at, std::uint32_t point) {
  std::vector<glm::ivec2> match;
  for (const auto& member : at) match.push_back(member[point]);
  return match;
}

void applyGuard(const AlignmentGuard& guard, std::span<const Moved> moved, std::size_t member, Positions& at,
                CycleCounts& counts) {
  counts.moved += moved.size();
  if (!guard) return;
  for (const Moved& m : moved) {
    if (guard(m.point, matchOf(at, m.point))) continue;
    at[member][m.point] = m.from;
    ++counts.refused;
    --counts.moved;
  }
}

}  // namespace ibr
