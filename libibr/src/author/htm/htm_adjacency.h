// SPDX-License-Identifier: Apache-2.0
// What lies around the vertices of a triangle mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

/// Lists of different lengths, one after the other.
struct Lists {
  std::vector<std::uint32_t> first;  // one more than there are lists
  std::vector<std::uint32_t> values;
  std::span<const std::uint32_t> operator[](std::size_t list) const {
    return std::span(values).subspan(first[list], first[list + 1] - first[list]);
  }
};

/// The faces at each vertex, ascending.
Lists facesAtVertices(const TriangleMesh& mesh);

/// The other ends of each vertex's edges, ascending.
Lists neighboursOfVertices(const TriangleMesh& mesh);

}  // namespace ibr
