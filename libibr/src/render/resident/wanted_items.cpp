// SPDX-License-Identifier: Apache-2.0
#include "render/resident/wanted_items.h"

#include <utility>

#include "render/photographs/photograph_choice.h"
#include "render/plan/draw_order.h"

namespace ibr {

WantedItems::WantedItems(const Scene& scene, std::vector<bool> isStreamed)
    : items_(scene),
      isStreamed_(std::move(isStreamed)),
      cellsOfNode_(scene.nodes.size()),
      backdropOfNode_(scene.nodes.size(), kNone),
      seen_(items_.count(), 0),
      reached_(scene.cells.size(), 0) {
  for (std::uint32_t c = 0; c < scene.cells.size(); ++c) {
    cells_.push_back(scene.cells[c].members);
    for (const std::uint32_t member : cells_[c]) cellsOfNode_[member].push_back(c);
  }
  for (const std::uint32_t b : gatherableBackdrops(scene)) backdropOfNode_[scene.backdrops[b].members[0]] = b;
  listed_.reserve(items_.count());
  around_.reserve(items_.count());
  queue_.reserve(cells_.size());
}

void WantedItems::update(const FramePlan& plan, std::size_t most) {
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
