// SPDX-License-Identifier: Apache-2.0
// Builds a balanced binary tree over a list of items, which is halved until the parts are small.
//
//   struct Node : HalvedNode { …bounds of the items… };
//   std::vector<Node> nodes = halvedTree(std::span(items), leafSize, boundsOf, orderOf);
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace ibr {

struct HalvedNode {
  std::uint32_t first = 0, end = 0;  // of the items
  std::uint32_t second = 0;          // the second child; the first one follows the node. 0: a leaf
};

/// Maximum number of nodes that a depth-first search keeps open: each level halves a number of 32 bits.
inline constexpr std::size_t kMaxHalvings = 33;

/// Sorts `items` by leaves, each of at most `leafSize` items, >= 1. Returns the nodes: the first is the root; none
/// without items. `boundsOf(items)`: a new node of a range. `orderOf(node, items)`: a strict weak order by which the
/// range is halved.
template <class Item, class BoundsOf, class OrderOf>
auto halvedTree(std::span<Item> items, std::uint32_t leafSize, const BoundsOf& boundsOf, const OrderOf& orderOf) {
  std::vector<std::invoke_result_t<BoundsOf, std::span<const Item>>> nodes;
  const auto build = [&](const auto& self, std::uint32_t first, std::uint32_t end) -> void {
    const std::span<Item> range = items.subspan(first, end - first);
    const std::size_t at = nodes.size();
    nodes.push_back(boundsOf(std::span<const Item>(range)));
    nodes[at].first = first;
    nodes[at].end = end;
    if (range.size() <= leafSize) return;
    const std::uint32_t half = first + (end - first) / 2;
    std::nth_element(range.begin(), range.begin() + (half - first), range.end(),
                     orderOf(nodes[at], std::span<const Item>(range)));
    self(self, first, half);
    nodes[at].second = std::uint32_t(nodes.size());
    self(self, half, end);
  };
  if (!items.empty()) build(build, 0, std::uint32_t(items.size()));
  return nodes;
}

}  // namespace ibr
