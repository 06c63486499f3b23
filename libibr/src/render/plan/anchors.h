// SPDX-License-Identifier: Apache-2.0
// Where cells that show the same photograph can be compared ([T] §2.6.4): places on one grid over each photograph,
// looked up in every cell that shows it. At a place each cell has a point of its own. Pure.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

inline constexpr std::uint32_t kAnchorSide = 16;  // places along each side of a photograph

/// For every node, how many of the scene's cells show it.
std::vector<std::uint32_t> cellsOfNodes(const Scene& scene);

/// The cell's tier 0 at places of photographs that are in two cells or more: the nearest surface along the
/// photograph's ray. Sorted by photograph, then place, each once. Time goes with the number of triangles.
std::vector<CellBounds::Anchor> anchorsOf(const Scene& scene, const Cell& cell,
                                          std::span<const std::uint32_t> cellsOfNode);

/// Points of the cell's tier 0, spread over its first member's picture: at (x, y, z) / w from that photograph's place,
/// world axes; w >= 0, 0 at infinity. At most kAnchorSide² / 2.
std::vector<glm::vec4> surfacePoints(const Scene& scene, const Cell& cell);

/// Those of all cells, looked up when they are first asked for: scenes that are not aligned do not pay for them. By
/// any thread.
class AnchorsOnDemand {
 public:
  using OfCells = std::vector<std::vector<CellBounds::Anchor>>;  // as those of the scene
  /// Always of the same scene.
  const OfCells& of(const Scene& scene);

 private:
  std::once_flag once_;
  OfCells all_;
};

}  // namespace ibr
