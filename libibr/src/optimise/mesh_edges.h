// SPDX-License-Identifier: Apache-2.0
// Edges of an alignment's triangles, for flips and insertions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "ibr/optimiser.h"

namespace ibr {

struct MeshEdges {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  std::map<Edge, std::size_t> beside;  // judged triangle by its directed edge
  std::set<Edge> all;                  // of all triangles, ends ascending
  std::set<Edge> barred;               // those of triangles only kept, and of more than two judged ones

  MeshEdges() = default;
  explicit MeshEdges(const Alignment& alignment);

  static Edge either(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }
  /// Judged triangle on the other side of the edge (a, b), or `none` if there is none or the edge is barred.
  std::size_t beyond(std::uint32_t a, std::uint32_t b) const;
  static constexpr std::size_t none = ~std::size_t(0);
};

/// Corner of a triangle other than a and b.
std::uint32_t opposite(const glm::uvec3& triangle, std::uint32_t a, std::uint32_t b);

}  // namespace ibr
