// SPDX-License-Identifier: Apache-2.0
// Visits a plan's cells in draw order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

inline constexpr std::uint32_t kNoCell = ~0u;

/// Draw order of the plan, or the previous one while two are cross-faded.
enum class Order : std::uint8_t { current, previous };

/// Calls `visit` with every cell of the order, its index (kNoCell: fading out) and its rank, best first. The rank of a
/// cell that fades out is that of the cell that it is drawn before.
template <class Visit>
void forCells(const FramePlan& plan, Order order, Visit&& visit) {
  const std::vector<PlannedCell>& cells = order == Order::current ? plan.cells : plan.previous;
  std::size_t left = order == Order::current ? 0 : plan.fadingOut.size();
  for (std::size_t c = 0; c <= cells.size(); ++c) {
    for (; left < plan.fadingOut.size() && plan.fadingOut[left].drawnBefore <= c; ++left)
      visit(plan.fadingOut[left].planned, kNoCell, std::uint32_t(c));
    if (c < cells.size()) visit(cells[c], std::uint32_t(c), std::uint32_t(c));
  }
}

}  // namespace ibr
