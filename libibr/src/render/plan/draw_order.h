// SPDX-License-Identifier: Apache-2.0
// The order in which a plan's cells are drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

inline constexpr std::uint32_t kNoCell = ~0u;

/// The picture of the plan's order, or of the order before a switch.
enum class Order : std::uint8_t { current, former };

/// Calls `visit` with every cell of the order and its number, those that leave between them.
template <class Visit>
void forCells(const FramePlan& plan, Order order, Visit&& visit) {
  const std::vector<PlannedCell>& cells = order == Order::current ? plan.cells : plan.former;
  std::size_t left = order == Order::current ? 0 : plan.leaving.size();
  for (std::size_t c = 0; c <= cells.size(); ++c) {
    for (; left < plan.leaving.size() && plan.leaving[left].before <= c; ++left)
      visit(plan.leaving[left].planned, kNoCell, std::uint32_t(c));
    if (c < cells.size()) visit(cells[c], std::uint32_t(c), std::uint32_t(c));
  }
}

}  // namespace ibr
