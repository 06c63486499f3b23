// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 7 with fig. 4: chosen faces are divided into four at their edges' middles, their neighbours so that the mesh
// stays one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

struct SubdividedMesh {
  TriangleMesh mesh;                  // the first vertices are those of before, with their indices
  std::vector<glm::uvec2> parents;    // of each further vertex: the ends of the edge whose middle it is, ascending
  std::vector<std::uint32_t> faceOf;  // for each face the one it came from, ascending
};

/// A face with k edges that a chosen face has too becomes k + 1 faces, the paper's types 0 to 3; a chosen one four.
/// With two such edges the shorter diagonal divides what is left. An edge's middle is one vertex for all its faces,
/// also where more than two meet. `chosen`: for each face, whether. Throws Error{invalidInput} where its length or an
/// index is wrong, or there would be too many vertices.
SubdividedMesh subdivideFaces(const TriangleMesh& mesh, std::span<const std::uint8_t> chosen);

/// Complements (or anything else at complementIndex) of the divided mesh: those of its `before` first vertices as they
/// are, of further ones the mean of their parents'. May be empty, and is then.
std::vector<glm::vec2> dividedComplements(std::span<const glm::vec2> complements, std::size_t cameras,
                                          std::size_t before, std::span<const glm::uvec2> parents);

}  // namespace ibr
