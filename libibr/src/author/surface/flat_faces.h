// SPDX-License-Identifier: Apache-2.0
// Faces whose three corners lie on a line.
#pragma once

#include <cstddef>

#include "ibr/htm_model.h"

namespace ibr {

struct FlatFaces {
  std::size_t removed = 0, left = 0;
};

/// Whether a face's height over its longest edge is less than 1e-9 of that edge.
bool isFlat(const TriangleMesh& mesh, const glm::uvec3& face);

/// Takes flat faces away without moving a vertex: the longest edge is turned, so that the middle corner becomes one of
/// the neighbour's, or, at a border, the face goes. `mesh` is oriented and manifold, before and after; vertices may
/// become unused.
FlatFaces removeFlatFaces(TriangleMesh& mesh);

}  // namespace ibr
