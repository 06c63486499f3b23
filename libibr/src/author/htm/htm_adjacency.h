// SPDX-License-Identifier: Apache-2.0
// Adjacency lists of a triangle mesh's vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

/// Lists of different lengths, stored one after the other.
struct Lists {
  std::vector<std::uint32_t> first;  // offsets into values: one more than there are lists
  std::vector<std::uint32_t> values;
  std::span<const std::uint32_t> operator[](std::size_t list) const {
    return std::span(values).subspan(first[list], first[list + 1] - first[list]);
  }
};

/// Indices of the faces at each vertex, ascending.
Lists facesAtVertices(const TriangleMesh& mesh);

/// Indices of each vertex's neighbours along edges, ascending.
Lists neighboursOfVertices(const TriangleMesh& mesh);

}  // namespace ibr
