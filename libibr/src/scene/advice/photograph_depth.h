// SPDX-License-Identifier: Apache-2.0
// What a scene's meshes know of the distances in its photographs, coarsely: enough to tell what a camera elsewhere
// would see of the same things.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

/// A photograph divided into cells of equal size, row by row from the top left.
struct PhotographDepth {
  int columns = 0, rows = 0;
  std::vector<float> inverseDistance;  // along the ray, 1 / world unit, >= 0; NaN where nothing is known
  std::vector<bool> agreed;            // whether a cell of the graph shows it by tier 0
  double near = 0, middle = 0;         // 90th percentile and median of the known inverse distances; 0 where none is

  glm::dvec2 pixel(const Intrinsics& k, int column, int row) const;  // the cell's middle
  float at(const Intrinsics& k, glm::dvec2 pixel) const;             // NaN outside the picture
  double agreedShare() const;
};

/// One a node: from its backdrop, else from the cells that it is a member of (the nearest surface). `longest`: cells of
/// the longer side. Precondition: validate(scene) is empty.
std::vector<PhotographDepth> photographDepths(const Scene& scene, int longest = 32);

}  // namespace ibr
