// SPDX-License-Identifier: Apache-2.0
// Cells that show the same photographs are moved a little, so that they agree on where its places are
// seen, though poses be wrong ([T] §2.6.4, fig. 14). Pure.
//
// At each anchor (render/plan/anchors.h) two cells differ by an angle, which for exact poses and matches is none.
// Between two cells that is brought to a small rigid motion, robustly; all motions x together minimise
//   Σ over pairs √(m_a m_b) (x_b − x_a − x_ab)ᵀ M_ab (x_b − x_a − x_ab) + κ Σ m_a x_a²
// so that cells near the view (mass m) hardly move, and those further off follow them. What is joined by it changes
// continuously with the view; nothing depends on the order of cells. At a photograph's own pose it counts alone, all
// that show it agree there, and they are not moved.
#pragma once

#include <span>
#include <vector>

#include "ibr/renderer.h"
#include "render/plan/barycentric.h"

namespace ibr {

inline constexpr double kLargestCorrection = 0.035;  // radians, about 2°

struct CellToAlign {
  const Cell* cell;
  std::span<const CellBounds::Anchor> anchors;
  Weights weights;  // of position, as it is drawn for `middle`
  double distance;  // from the middle of the views, world units, >= 0: its mass falls with it
};

/// A correction each, about the middle of the views.
std::vector<Correction> alignCells(const Scene& scene, std::span<const CellToAlign> cells, glm::dvec3 middle);

/// By how many pixels of a view meshes of a plan differ on places of shared photographs that both show in the picture:
/// one figure for each such place and pair of cells. With `corrected`, as they are drawn, else as they would be without
/// corrections. What nobody sees, since others hide it, counts too.
std::vector<double> misalignments(const Scene& scene, const SceneBounds& bounds, const FramePlan& plan,
                                  std::size_t view, bool corrected);

}  // namespace ibr
