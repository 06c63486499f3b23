// SPDX-License-Identifier: Apache-2.0
// Converts a cell's mesh to the optimiser's grid of 1/128 px (ibr/optimiser.h). Stored matches are finer than this
// grid. Rounding must not fold any judged triangle over.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/optimiser.h"
#include "ibr/scene.h"

namespace ibr {

struct AlignmentGrid {
  Alignment alignment;  // without images. Judged triangles: of tier 0, one orientation in all images and their means.
                        // Stored positive in the first image, whatever the orientation in the mesh
  std::vector<std::size_t> judged;  // index in the mesh of each of alignment.triangles
  std::size_t fixed = 0;  // number of fixed points: outside an image, or without a nearby grid point that unfolds the
                          // triangles around. Fixed points do not move; triangles around them are not judged
};

/// `size`: of each image, px. `fixed`: n flags or empty: points that must not move.
AlignmentGrid toAlignmentGrid(const MorphMesh& mesh, const std::vector<glm::ivec2>& size,
                              const std::vector<std::uint8_t>& fixed = {});

/// Applies the optimiser's result. Points that moved in an image, and points that only `to` has, get the matches of
/// `to`. All others keep their match in `mesh`, to the bit.
std::vector<std::vector<glm::vec2>> movedMatch(const MorphMesh& mesh, const std::vector<std::vector<glm::ivec2>>& from,
                                               const std::vector<std::vector<glm::ivec2>>& to);

}  // namespace ibr
