// SPDX-License-Identifier: Apache-2.0
// The order in which a plan's cells and backdrops are drawn, and which copies of backdrops come before a cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

inline constexpr std::uint32_t kNoCell = ~0u;

/// The picture of the plan's order, or of the order before a switch.
enum class Order : std::uint8_t { current, former };

/// Most copies of backdrops that are drawn before cells.
constexpr std::uint32_t copiesBeforeCells(std::size_t backdrops) {
  return 4 * std::uint32_t(std::min<std::size_t>(backdrops, kLargestBackdropCount));
}

/// Share of the pixels of a backdrop that come before a cell, from 0 to 1 as its photograph is nearer than half as far
/// away as the cell is: the mean of how far the view is outside of it and how far away the photographs are that it
/// shows; never more than the cell's opacity. Inside of a regular cell its own members never come first.
double shareBefore(const FramePlan& plan, const PlannedBackdrop& backdrop, const PlannedCell& cell) noexcept;

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

/// Of each of the plan's backdrops, how much of it has been drawn.
using BackdropShares = std::array<double, 2 * kLargestBackdropCount>;

/// Calls `cell` as forCells does, and before a cell `backdrop` with the number of one and its share by then: copies use
/// one noise, so each adds to those before it. `backdrops`: of the scene. Returns what the last copies have.
template <class VisitBackdrop, class VisitCell>
BackdropShares forTier0(const FramePlan& plan, Order order, std::size_t backdrops, VisitBackdrop&& backdrop,
                        VisitCell&& cell) {
  constexpr double kLeastShare = 0.125;  // that another copy is drawn for
  BackdropShares shown{};
  std::uint32_t copies = copiesBeforeCells(backdrops);
  forCells(plan, order, [&](const PlannedCell& planned, std::uint32_t c, std::uint32_t rank) {
    for (std::uint32_t b = 0; b < plan.backdrops.size() && copies > 0; ++b) {
      const double share = shareBefore(plan, plan.backdrops[b], planned);
      if (shown[b] == 1 || share < std::min(1.0, shown[b] + kLeastShare)) continue;
      backdrop(b, shown[b] = share);
      --copies;
    }
    cell(planned, c, rank);
  });
  return shown;
}

}  // namespace ibr
