// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/box_tree.h"

#include <algorithm>

namespace ibr::app {
namespace {

constexpr std::uint32_t kLeafSize = 8;

int longestSide(const Box& box) {
  const glm::dvec3 size = box.high - box.low;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

class Builder {
 public:
  Builder(BoxTree& tree, const std::function<Box(std::uint32_t)>& boxOf) : tree_(tree), boxOf_(boxOf) {
    for (const std::uint32_t item : tree.items) {
      const Box box = boxOf(item);
      items_.push_back({0.5 * box.low + 0.5 * box.high, item});
    }
    if (!items_.empty()) build(0, std::uint32_t(items_.size()));
  }

 private:
  struct Item {
    glm::dvec3 middle;
    std::uint32_t number;
  };

  // Appends the nodes of a range of items, and returns their box.
  Box build(std::uint32_t first, std::uint32_t end) {
    const std::size_t at = tree_.nodes.size();
    tree_.nodes.push_back({{}, first, end, 0});
    Box box;
    const auto include = [&box](const Box& part) {
      box.low = glm::min(box.low, part.low);
      box.high = glm::max(box.high, part.high);
    };
    if (end - first <= kLeafSize) {
      for (std::uint32_t i = first; i < end; ++i) include(boxOf_(tree_.items[i] = items_[i].number));
    } else {
      const std::uint32_t half = first + (end - first) / 2;
      halve(first, half, end);
      include(build(first, half));
      tree_.nodes[at].second = std::uint32_t(tree_.nodes.size());
      include(build(half, end));
    }
    return tree_.nodes[at].box = box;
  }

  // Sorts by the longest side of the box around the items' middles.
  void halve(std::uint32_t first, std::uint32_t half, std::uint32_t end) {
    Box middles;
    for (std::uint32_t i = first; i < end; ++i) {
      middles.low = glm::min(middles.low, items_[i].middle);
      middles.high = glm::max(middles.high, items_[i].middle);
    }
    const int axis = longestSide(middles);
    const auto begin = items_.begin();
    std::nth_element(begin + first, begin + half, begin + end,
                     [axis](const Item& a, const Item& b) { return a.middle[axis] < b.middle[axis]; });
  }

  BoxTree& tree_;
  const std::function<Box(std::uint32_t)>& boxOf_;
  std::vector<Item> items_;
};

}  // namespace

BoxTree makeBoxTree(std::vector<std::uint32_t> items, const std::function<Box(std::uint32_t)>& boxOf) {
  BoxTree tree;
  tree.items = std::move(items);
  Builder(tree, boxOf);
  return tree;
}

}  // namespace ibr::app
