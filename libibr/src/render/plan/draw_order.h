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

/// Factor on a backdrop's distance where it is compared with a cell's, dimensionless: no second photograph confirms a
/// backdrop's depth.
inline constexpr double kBackdropDistanceFactor = 2;

/// Band of that product over which a backdrop passes a cell, as a share of the cell's distance; tuned on
/// path_lund_street: see docs/quality.md.
inline constexpr double kPassingBand = 0.1;

/// Returns the share of a backdrop's tier 0 that is drawn before a cell, from 0 to the cell's opacity:
///
///   ½ + (1 − kBackdropDistanceFactor · d / D) / kPassingBand,
///
/// d the distance of the backdrop's photograph from the middle of the views, D the cell's distance: the mean of
/// PlannedCell::extrapolationDistance and photographDistance; both in world units. So the backdrop begins to pass the
/// cell at d = .525 D, and has passed it at .475 D. Where nothing fades (switchSeconds is 0) it passes at once, at ½ D.
/// Returns 0 where D is 0, and with the paper's colour sequence. Inside of a regular cell its members never come first.
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
