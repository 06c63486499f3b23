// SPDX-License-Identifier: Apache-2.0
// Chooses the cells in view that together cover the views best (cell_cover.h), and sorts them ([T] §2.5.2): by
// extrapolation, then by rotational distance. Pure. A cell overtakes another only by a margin, so that a camera on the
// border between two cells does not flicker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>

#include "ibr/frame_plan.h"

namespace ibr {

inline constexpr std::int64_t kNotShown = std::numeric_limits<std::int64_t>::max();

/// A cell that is in view, or may be after its correction.
struct CellCandidate {
  std::uint32_t cell;
  double extrapolation, rotation;  // CellDistance: world units, radians
  double size;                     // of the cell: its longest edge
  bool nearlyInView;               // only its correction may bring it into view; sorted last
  bool first;                      // first regardless of the others, because a cross-fade to this cell is in progress
  std::int64_t rank;               // in the previous frame, or kNotShown
  double distance;    // from the midpoint of the views: mean of extrapolation and photographDistance, world units
  std::size_t index;  // of the caller
};

/// Maximum number of candidates, best first, that the cover search considers.
inline constexpr std::size_t kMaxCoverCandidates = 64;

/// Chooses at most `most` of the candidates; all if there are no more and nothing is gathered. Moves the chosen ones to
/// the front, best first, and returns their number. `gathers`: the gather draws what cells leave open, so only cells
/// worth more than the gather are chosen.
std::size_t chooseCells(const SceneBounds& bounds, std::span<const Camera> views, std::span<CellCandidate> candidates,
                        std::size_t most, bool gathers, std::pmr::memory_resource* memory);

}  // namespace ibr
