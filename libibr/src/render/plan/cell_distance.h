// SPDX-License-Identifier: Apache-2.0
// Distance of the virtual camera from a cell, in position and in direction ([T] §2.5.2).
#pragma once

#include "render/plan/barycentric.h"
#include "render/plan/cell_poses.h"

namespace ibr {

struct CellDistance {
  Barycentric weights;       // of the virtual camera, in the order of the cell's members
  double extrapolation = 0;  // world units; exactly 0 inside, within rounding
  double rotation = 0;       // radians between the virtual axis and the cell's interpolated axis (yaw and pitch only);
                             // 0 for a cell of panoramas
};

/// `size` is the cell's longest edge. Cells over the same positions get bit-equal extrapolation distances in any order
/// of their members, so that only the direction distinguishes stacked cells.
CellDistance cellDistance(const CellPoses& cell, double size, const Pose& view);

/// Returns the largest absolute coordinate, which the rounding of positions is relative to.
double largestCoordinate(glm::dvec3 v);

/// CellDistance::weights alone.
Barycentric cellWeights(const CellPoses& cell, glm::dvec3 position);

}  // namespace ibr
