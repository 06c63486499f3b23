// SPDX-License-Identifier: Apache-2.0
#include "render/resident/wanted_nodes.h"

#include <utility>

#include "render/plan/draw_order.h"

namespace ibr {

WantedNodes::WantedNodes(std::vector<std::vector<std::uint32_t>> cells, std::size_t nodeCount)
    : cells_(std::move(cells)), cellsOfNode_(nodeCount), seen_(nodeCount, 0), reached_(cells_.size(), 0) {
  for (std::uint32_t c = 0; c < cells_.size(); ++c)
    for (const std::uint32_t member : cells_[c]) cellsOfNode_[member].push_back(c);
  nodes_.reserve(nodeCount);
  queue_.reserve(cells_.size());
}

void WantedNodes::update(const FramePlan& plan, std::size_t most) {
  ++update_;
  nodes_.clear();
  queue_.clear();
  for (const PlannedPhotograph& photograph : plan.photographs) addNode(photograph.node);
  if (plan.settings.composition != Composition::gathered)
    for (const Order order : {Order::current, Order::previous})
      forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t, std::uint32_t) { addMembers(cell.cell); });
  needed_ = nodes_.size();

  if (!plan.cells.empty()) reach(plan.cells[0].cell);
  for (std::size_t i = 0; i < queue_.size() && nodes_.size() < most; ++i) {
    addMembers(queue_[i]);
    for (const std::uint32_t member : cells_[queue_[i]])
      for (const std::uint32_t cell : cellsOfNode_[member]) reach(cell);
  }
}

void WantedNodes::addMembers(std::uint32_t cell) {
  for (const std::uint32_t member : cells_[cell]) addNode(member);
}

void WantedNodes::addNode(std::uint32_t node) {
  if (std::exchange(seen_[node], update_) != update_) nodes_.push_back(node);
}

void WantedNodes::reach(std::uint32_t cell) {
  if (std::exchange(reached_[cell], update_) != update_) queue_.push_back(cell);
}

}  // namespace ibr
