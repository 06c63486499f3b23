// SPDX-License-Identifier: Apache-2.0
// Fades between draw orders, so that changes of rank do not show as jumps.
//
// A cell that changes its rank is drawn twice for a while. The copy farther back stays opaque. The copy in front fades
// out if the cell fell back, and fades in if the cell came forward. A cell that was left out fades in. A cell that is
// not drawn any more keeps its rank until all arriving cells are opaque, then fades out. A cell that comes into view is
// opaque at once, because it enters at the border of the image.
//
//   the longest common subsequence of shown and wanted order stays; other cells fade out, and are inserted again
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

struct WantedOrder {
  std::span<const std::uint32_t> cells;         // best first, each once
  std::span<const std::uint32_t> hidden;        // in view in the previous frame, but not drawn; ascending
  std::span<const std::uint32_t> stillVisible;  // in view and in the previous order, but not wanted any more; ascending
  bool backed = false;                          // something else is drawn where there is no cell
};

/// Computes the cells of this frame: the wanted cells in their order, and between them at most kMaxFadingOutCount that
/// fade out. `step`: this frame's share of a fade; 1 or more cuts. Also cuts, unless the order is backed, if `before`
/// is empty or leaves nothing in view. `shown` is overwritten; `memory` is used for the call.
void advanceFades(std::span<const DrawOrderEntry> before, const WantedOrder& wanted, double step,
                  std::pmr::memory_resource* memory, std::vector<DrawOrderEntry>& shown);

}  // namespace ibr
