// SPDX-License-Identifier: Apache-2.0
// Aligns cells that show the same photographs by small rigid motions ([T] §2.6.4, fig. 14). The cells then agree on the
// directions of common points, in spite of inaccurate poses. Pure.
//
// At each anchor (render/plan/anchors.h) two cells differ by an angle, which is 0 for exact poses and matches. A robust
// fit explains these angles by one rigid motion x_ab per pair of cells. All motions x together minimise
//   Σ over pairs √(m_a m_b) (x_b − x_a − x_ab)ᵀ M_ab (x_b − x_a − x_ab) + κ Σ m_a x_a²
// The mass m is large for cells near the view: they hardly move, and farther cells follow. The result is continuous
// in the view and does not depend on the order of cells. At a photograph's own pose only that photograph counts: all
// cells that show it agree there, and they are not moved.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"
#include "render/plan/barycentric.h"

namespace ibr {

inline constexpr double kMaxCorrectionRadians = 0.035;  // largest angle of a correction, radians, about 2°

struct CellToAlign {
  const Cell* cell;
  std::span<const CellBounds::Anchor> anchors;
  Weights weights;  // of position, as drawn for `middle`
  double distance;  // from the midpoint of the views, world units, >= 0: the cell's mass decreases with it
};

/// Returns one correction per cell, about the midpoint of the views.
std::pmr::vector<Correction> alignCells(const Scene& scene, std::span<const CellToAlign> cells, glm::dvec3 middle,
                                        std::pmr::memory_resource* memory = std::pmr::get_default_resource());

}  // namespace ibr
