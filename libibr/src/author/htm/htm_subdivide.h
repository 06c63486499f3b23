// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 7 with fig. 4: divides chosen faces into four at their edges' midpoints. Their neighbours are divided to
// match, so that the mesh has no cracks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

struct SubdividedMesh {
  TriangleMesh mesh;                  // the source mesh's vertices come first, with their indices
  std::vector<glm::uvec2> parents;    // of each further vertex: ends of the divided edge, ascending
  std::vector<std::uint32_t> faceOf;  // source face of each face, ascending
};

/// A face that shares k divided edges with chosen faces becomes k + 1 faces, the paper's types 0 to 3; a chosen face
/// becomes four. With k = 2 the shorter diagonal divides the remaining quadrilateral. An edge's midpoint is one vertex
/// for all its faces, even if more than two meet. `chosen`: a flag for each face. Throws Error{invalidInput} if its
/// length or an index is wrong, or the number of vertices overflows.
SubdividedMesh subdivideFaces(const TriangleMesh& mesh, std::span<const std::uint8_t> chosen);

/// Returns the complements (or other values at complementIndex) of the divided mesh. The `before` first vertices keep
/// theirs; further vertices get the mean of their parents'. Empty in, empty out.
std::vector<glm::vec2> dividedComplements(std::span<const glm::vec2> complements, std::size_t cameras,
                                          std::size_t before, std::span<const glm::uvec2> parents);

}  // namespace ibr
