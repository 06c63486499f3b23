// SPDX-License-Identifier: Apache-2.0
// Which of the cells in view are drawn: those that together cover the views best (cell_cover.h). In which order ([T]
// §2.5.2): by extrapolation, then by rotational distance. Pure. A cell overtakes another only by a margin, so that a
// camera on the border of two does not flicker.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "ibr/renderer.h"
#include "ibr/scene.h"

namespace ibr {

inline constexpr std::int64_t kNotShown = std::numeric_limits<std::int64_t>::max();

/// A cell that is in view, or may be.
struct CellCandidate {
  std::uint32_t cell;
  double extrapolation, rotation;  // CellDistance: world units, radians
  double size;                     // of the cell: its longest edge
  bool nearlyInView;               // only its correction may bring it into view: last of all
  bool first;                      // whatever the others are: a switch to it is going on
  std::int64_t rank;               // in the frame before, or kNotShown
  double distance;    // from the middle of the views: mean of extrapolation and its photographs', world units
  std::size_t index;  // the caller's own
};

struct CellChoice {
  std::vector<CellCandidate> drawn;  // at most as many as asked for, best first
  std::vector<CellCandidate> left;
};

/// So many candidates at most, best first by the order above, take part in the choice.
inline constexpr std::size_t kMostCovering = 64;

/// At most `most` of the candidates; all, where there are no more and nothing is gathered. `gathers`: what cells leave
/// open is gathered, and only those are drawn that are worth more. `bounds`: of the scene.
CellChoice chooseCells(const Scene& scene, const SceneBounds& bounds, std::span<const Camera> views,
                       std::vector<CellCandidate> candidates, std::size_t most, bool gathers);

/// Poses of a cell's members, sorted: what tells two cells apart wherever they stand in the file.
std::vector<std::array<double, 7>> memberPoses(const Scene& scene, const Cell& cell);

}  // namespace ibr
