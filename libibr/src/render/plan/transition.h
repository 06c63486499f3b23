// SPDX-License-Identifier: Apache-2.0
// Changes in the order of cells that nobody sees as a jump.
//
// A cell that changes its place is there twice for a while: the copy further back stays as it is, the one in front
// fades, out where the cell fell back, in where it came forward. A cell that had been left out fades in; one that is no
// longer drawn waits where it was for what arrives, then fades out. What comes into view is there at once: it enters at
// the border of the picture.
//
//   the longest common subsequence of the orders shown and wanted stays; all others leave, and enter anew
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

struct WantedOrder {
  std::span<const std::uint32_t> cells;                  // best first, each once
  std::function<bool(std::uint32_t cell)> wasHidden;     // visible in the frame before, and not drawn
  std::function<bool(std::uint32_t cell)> stillVisible;  // of a cell that is no longer wanted
  bool backed = false;                                   // something else shows where no cell does
};

/// What this frame shows: the wanted cells in their order, and between them those that leave, at most
/// kLargestLeavingCount. `step` is the share of a fade that this frame goes; 1 or more cuts, and so does a `before`
/// that is empty or leaves nothing in view, unless the order is backed.
std::vector<ShownCell> showCells(std::span<const ShownCell> before, const WantedOrder& wanted, double step);

}  // namespace ibr
