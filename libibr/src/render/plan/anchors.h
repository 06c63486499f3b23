// SPDX-License-Identifier: Apache-2.0
// Anchors: points of a grid over each photograph ([T] §2.6.4), looked up in every cell that shows the photograph.
// Alignment compares the cells at their common anchors; each cell has its own 3D point there. Pure.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

inline constexpr std::uint32_t kAnchorSide = 16;  // grid points along each side of a photograph

/// Returns for every node the number of the scene's cells that show its photograph.
std::vector<std::uint32_t> cellsOfNodes(const Scene& scene);

/// Returns the cell's anchors in photographs that two or more cells show: the nearest surface of tier 0 along the
/// photograph's ray. Sorted by photograph, then grid point; no duplicates. Time is linear in the number of triangles.
std::vector<CellBounds::Anchor> anchorsOf(const Scene& scene, const Cell& cell,
                                          std::span<const std::uint32_t> cellsOfNode);

/// Returns points of the cell's tier 0, spread over the first member's image: (x, y, z) / w from that photograph's
/// position, world axes; w >= 0, 0 at infinity. At most kAnchorSide² / 2.
std::vector<glm::vec4> surfacePoints(const Scene& scene, const Cell& cell);

/// Anchors of all cells. The first call computes them, so that scenes without alignment need no time and memory for
/// them. Thread-safe.
struct SceneBounds::Anchors {
  using OfCells = std::vector<std::vector<CellBounds::Anchor>>;  // in the order of Scene::cells
  /// Precondition: every call passes the same scene. A requested stop throws Error{cancelled} before the next cell; the
  /// next call starts again.
  const OfCells& of(const Scene& scene, const std::stop_token& stop = {});

 private:
  std::once_flag once_;
  OfCells all_;
};

}  // namespace ibr
