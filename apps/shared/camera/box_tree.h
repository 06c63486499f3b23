// SPDX-License-Identifier: Apache-2.0
// Hierarchy of boxes over numbered items, such as positions or line segments. A search visits only boxes that may hold
// a better item, so its time hardly grows with the number of items.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "base/halved_tree.h"

namespace ibr::app {

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

struct BoxTree {
  struct Node : HalvedNode {
    Box box;
  };
  std::vector<Node> nodes;           // the first is the root; none without items
  std::vector<std::uint32_t> items;  // in the order of the leaves
};

/// Builds a balanced tree. `boxOf(item)`: finite.
BoxTree makeBoxTree(const std::vector<std::uint32_t>& numbers, const std::function<Box(std::uint32_t)>& boxOf);

/// Returns the distance from a point to a box; 0 inside.
inline double distanceToBox(const Box& box, glm::dvec3 point) {
  return glm::length(glm::max(glm::max(box.low - point, point - box.high), glm::dvec3(0)));
}

/// Offers items to a search for low costs, cheaper boxes first. `bound(box)`: a lower bound of the costs of the items
/// in the box. `offer(item)` returns the new limit. A box is left out if its bound exceeds the limit. Allocates
/// nothing.
template <class Bound, class Offer>
void searchBoxes(const BoxTree& tree, double limit, const Bound& bound, const Offer& offer) {
  struct Open {
    std::uint32_t node;
    double bound;
  };
  std::array<Open, kMaxHalvings> open;
  std::size_t count = 0;
  if (!tree.nodes.empty()) open[count++] = {0, bound(tree.nodes[0].box)};
  while (count > 0) {
    const Open at = open[--count];
    if (at.bound > limit) continue;
    const BoxTree::Node& node = tree.nodes[at.node];
    if (node.second == 0) {
      for (std::uint32_t i = node.first; i < node.end; ++i) limit = offer(tree.items[i]);
      continue;
    }
    Open next{at.node + 1, bound(tree.nodes[at.node + 1].box)};
    Open later{node.second, bound(tree.nodes[node.second].box)};
    if (later.bound < next.bound) std::swap(next, later);
    open[count++] = later;
    open[count++] = next;
  }
}

}  // namespace ibr::app
