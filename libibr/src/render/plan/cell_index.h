// SPDX-License-Identifier: Apache-2.0
// Bounding volume hierarchy over a scene's cells: finds the cells that a frame may draw in time that hardly depends on
// the number of other cells. Pure.
//
// A subtree is left out as a whole only where each of its cells would certainly be culled, and is counted under the
// reason for which each would be culled alone: a cell beyond the extrapolation limit is culled by distance, another one
// by the frustum. The tests of a subtree bound those of its cells with a margin for rounding:
//
//   distance  The camera's distance from a simplex is at least that from any box around its corners.
//   frustum   D = Σ λ_i a_i R_i q_i + ρ·(Σ λ_i c_i − p) with λ in the simplex: both sums lie in boxes around the terms.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/halved_tree.h"
#include "ibr/frame_plan.h"
#include "render/plan/cell_poses.h"

namespace ibr {

struct CellIndex {
  struct Node : HalvedNode {
    glm::dvec3 low{0.0}, high{0.0};             // box of the members' positions, world
    glm::vec3 shownLow{0.0f}, shownHigh{0.0f};  // box of the vertices' a_i R_i q_i, world axes
    double minSize = 0, maxSize = 0;            // of the cells, world units
    double reach = 0;                           // upper bound of |a_i R_i q_i|
    float maxInverseDistance = 0;               // of the vertices, ρ
  };
  std::vector<Node> nodes;           // over `cells`
  std::vector<std::uint32_t> cells;  // indices into Scene::cells, in the order of the leaves
  std::vector<CellPoses> poses;      // as Scene::cells
};

/// `cells`: bounds of the scene's cells. A leaf has at most `leafSize` cells, >= 1.
CellIndex makeCellIndex(const Scene& scene, std::span<const CellBounds> cells, std::uint32_t leafSize = 1);

struct CellQuery {
  Pose middle;            // midway between the views
  double limit = 0;       // RenderSettings::extrapolationLimit
  bool byFrustum = true;  // false: no cell is left out for its direction, because weights are free or cells may move
  struct View {
    std::array<glm::dvec3, 4> planes;  // frustum(): unit normals
    glm::dvec3 eye;
  };
  std::span<const View> views;
};

struct CulledCells {
  std::uint32_t byDistance = 0, byFrustum = 0;  // numbers of cells
  std::uint32_t visitedNodes = 0;               // of the index
};

/// Appends the cells that may be near enough and in view, in ascending order, and counts the others.
CulledCells findCells(std::span<const CellBounds> bounds, const CellIndex& index, const CellQuery& query,
                      std::pmr::vector<std::uint32_t>& found);

}  // namespace ibr
