// SPDX-License-Identifier: Apache-2.0
// A cell's mesh as the optimiser wants it (ibr/optimiser.h): on a grid of 1/128 px. Stored matches stand on a finer one
// or on none; none of the triangles that are judged may turn over on the way.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/optimiser.h"
#include "ibr/scene.h"

namespace ibr {

struct AlignmentGrid {
  Alignment alignment;  // without pictures. Of tier 0, what turns the same way in all pictures and their means is
                        // judged; triangles are positive in the first picture whichever way they turn in the mesh
  std::vector<std::size_t> judged;  // number in the mesh of each of alignment.triangles
  std::size_t fixed = 0;  // points that the grid cannot hold: no grid point around them keeps what lies around them; or
                          // they lie outside a picture. They do not move, triangles around them are not judged
};

/// `size`: of each picture, px. `fixed`: n, or none: points that are not to move.
AlignmentGrid ontoGrid(const MorphMesh& mesh, const std::vector<glm::ivec2>& size,
                       const std::vector<std::uint8_t>& fixed = {});

/// What the optimiser did: matches of points that moved in a picture, or that only `to` has, are those of `to`, all
/// others stay as they are in `mesh`, to the bit.
std::vector<std::vector<glm::vec2>> movedMatch(const MorphMesh& mesh, const std::vector<std::vector<glm::ivec2>>& from,
                                               const std::vector<std::vector<glm::ivec2>>& to);

}  // namespace ibr
