// SPDX-License-Identifier: Apache-2.0
// The edges of an alignment's triangles, for those who join its points anew.
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

  std::map<Edge, std::size_t> beside;  // an edge as a judged triangle has it: that triangle
  std::set<Edge> all;                  // of all triangles, ends ascending
  std::set<Edge> barred;               // of them, of those only kept, and of more than two judged ones

  MeshEdges() = default;
  explicit MeshEdges(const Alignment& alignment);

  static Edge either(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }
  /// The judged triangle beyond edge (a, b) of a judged one, or `none`: there is none, or the edge is barred.
  std::size_t beyond(std::uint32_t a, std::uint32_t b) const;
  static constexpr std::size_t none = ~std::size_t(0);
};

/// The corner of a triangle that is neither.
std::uint32_t opposite(const glm::uvec3& triangle, std::uint32_t a, std::uint32_t b);

}  // namespace ibr
