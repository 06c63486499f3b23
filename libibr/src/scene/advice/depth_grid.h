// SPDX-License-Identifier: Apache-2.0
// Coarse distances in a scene's photographs, from its meshes. Accurate enough to estimate the visibility of the same
// surfaces from other cameras.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

/// A photograph divided into cells of equal size, row by row from the top left.
struct DepthGrid {
  int columns = 0, rows = 0;
  std::vector<float> inverseDistance;  // along the ray, 1 / world unit, >= 0; NaN if unknown
  std::vector<bool> agreed;            // a cell of the image graph shows the grid's cell by tier 0
  double near = 0, middle = 0;         // 90th percentile and median of the known inverse distances; 0 if none is known

  glm::dvec2 pixel(const Intrinsics& k, int column, int row) const;  // the cell's centre
  float at(const Intrinsics& k, glm::dvec2 pixel) const;             // NaN outside the image
  double agreedShare() const;
};

/// One per node: from its backdrop, else from the cells that it is a member of (the nearest surface). `longest`: number
/// of cells along the longer side. Precondition: validate(scene) is empty.
std::vector<DepthGrid> depthGrids(const Scene& scene, int longest = 32);

}  // namespace ibr
