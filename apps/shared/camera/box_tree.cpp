// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/box_tree.h"

#include <span>

namespace ibr::app {
namespace {

constexpr std::uint32_t kLeafSize = 8;

struct Item {
  Box box;
  std::uint32_t number;

  glm::dvec3 middle() const { return 0.5 * box.low + 0.5 * box.high; }
};

void include(Box& box, glm::dvec3 low, glm::dvec3 high) {
  box.low = glm::min(box.low, low);
  box.high = glm::max(box.high, high);
}

int longestSide(const Box& box) {
  const glm::dvec3 size = box.high - box.low;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace

BoxTree makeBoxTree(const std::vector<std::uint32_t>& numbers, const std::function<Box(std::uint32_t)>& boxOf) {
  std::vector<Item> items;
  for (const std::uint32_t number : numbers) items.push_back({boxOf(number), number});
  const auto nodeOf = [](std::span<const Item> range) {
    BoxTree::Node node;
    for (const Item& item : range) include(node.box, item.box.low, item.box.high);
    return node;
  };
  const auto alongLongestSide = [](const BoxTree::Node&, std::span<const Item> range) {
    Box middles;
    for (const Item& item : range) include(middles, item.middle(), item.middle());
    return [axis = longestSide(middles)](const Item& a, const Item& b) { return a.middle()[axis] < b.middle()[axis]; };
  };
  BoxTree tree;
  tree.nodes = halvedTree(std::span(items), kLeafSize, nodeOf, alongLongestSide);
  for (const Item& item : items) tree.items.push_back(item.number);
  return tree;
}

}  // namespace ibr::app
