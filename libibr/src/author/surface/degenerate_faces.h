// SPDX-License-Identifier: Apache-2.0
// Detects and removes faces whose three corners lie on a line.
#pragma once

#include <cstddef>

#include "ibr/htm_model.h"

namespace ibr {

struct DegenerateFaceCounts {
  std::size_t removed = 0, left = 0;
};

/// True if a face's height over its longest edge is at most 1e-9 of that edge.
bool isDegenerate(const TriangleMesh& mesh, const glm::uvec3& face);

/// Removes flat faces without moving a vertex: flips the longest edge, so that the middle corner becomes one of the
/// neighbour's, or drops a face at a border. `mesh` is oriented and manifold, before and after; vertices may become
/// unused.
DegenerateFaceCounts removeDegenerateFaces(TriangleMesh& mesh);

}  // namespace ibr
