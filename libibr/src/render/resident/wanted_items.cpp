// SPDX-License-Identifier: Apache-2.0
#include "render/resident/wanted_items.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "render/photographs/photograph_choice.h"
#include "render/plan/draw_order.h"

namespace ibr {

WantedItems::WantedItems(const Scene& scene, std::vector<bool> isStreamed)
    : items_(scene),
      isStreamed_(std::move(isStreamed)),
      backdropOfNode_(scene.nodes.size(), kNone),
      seen_(items_.count(), 0),
      reached_(scene.cells.size(), 0),
      opened_(scene.nodes.size(), 0) {
  for (const Cell& cell : scene.cells) {
    cells_.values.insert(cells_.values.end(), cell.members.begin(), cell.members.end());
    cells_.ends.push_back(std::uint32_t(cells_.values.size()));
  }
  cellsOfNode_ = cellsOfNodes(cells_, scene.nodes.size());
  for (const std::uint32_t b : gatherableBackdrops(scene)) backdropOfNode_[scene.backdrops[b].members[0]] = b;
  listed_.reserve(items_.count());
  around_.reserve(items_.count());
  queue_.reserve(scene.cells.size());
}

WantedItems::Lists WantedItems::cellsOfNodes(const Lists& cells, std::size_t nodeCount) {
  Lists lists{std::vector<std::uint32_t>(nodeCount, 0), std::vector<std::uint32_t>(cells.values.size())};
  for (const std::uint32_t node : cells.values) ++lists.ends[node];
  std::partial_sum(lists.ends.begin(), lists.ends.end(), lists.ends.begin());
  // Every list is filled from its end, with the last cell first.
  std::vector<std::uint32_t> next = lists.ends;
  for (std::size_t c = cells.ends.size(); c-- > 0;)
    for (const std::uint32_t node : cells[c]) lists.values[--next[node]] = std::uint32_t(c);
  return lists;
}

void WantedItems::update(const FramePlan& plan, std::size_t most) {
  most = std::min(most, kMaxListed);
  const bool gathers = plan.settings.composition != Composition::cells;
  if (plan.cells.empty()) {
    around_.clear();
    from_.reset();
  } else if (const From from{plan.cells[0].cell, gathers, most}; from_ != from) {
    findAround(from);
    from_ = from;
  }
  begin(listed_);
  for (const PlannedPhotograph& photograph : plan.photographs) addGathered(photograph.node);
  if (plan.settings.composition != Composition::gathered)
    for (const Order order : {Order::current, Order::previous})
      forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t, std::uint32_t) { addCell(cell.cell); });
  needed_ = listed_.size();
  for (auto item = around_.begin(); item != around_.end() && listed_.size() < most; ++item) add(*item);
}

void WantedItems::findAround(const From& from) {
  begin(around_);
  queue_.clear();
  reach(from.cell);
  for (std::size_t i = 0; i < queue_.size() && around_.size() < from.most; ++i) {
    addCell(queue_[i]);
    for (const std::uint32_t member : cells_[queue_[i]]) {
      if (std::exchange(opened_[member], update_) == update_) continue;
      if (from.gathers) addGathered(member);
      for (const std::uint32_t cell : cellsOfNode_[member]) reach(cell);
    }
  }
}

void WantedItems::begin(std::vector<std::uint32_t>& list) {
  ++update_;
  list.clear();
  list_ = &list;
}

void WantedItems::addCell(std::uint32_t cell) {
  addStreamed(items_.cell(cell));
  for (const std::uint32_t member : cells_[cell]) add(member);
}

void WantedItems::addGathered(std::uint32_t node) {
  add(node);
  if (backdropOfNode_[node] == kNone) return;
  addStreamed(items_.depth(node));
  addStreamed(items_.backdrop(backdropOfNode_[node]));
}

void WantedItems::addStreamed(std::uint32_t item) {
  if (isStreamed_[item]) add(item);
}

void WantedItems::add(std::uint32_t item) {
  if (std::exchange(seen_[item], update_) != update_) list_->push_back(item);
}

void WantedItems::reach(std::uint32_t cell) {
  if (std::exchange(reached_[cell], update_) != update_) queue_.push_back(cell);
}

}  // namespace ibr
