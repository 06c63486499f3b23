// SPDX-License-Identifier: Apache-2.0
// Photographs that a plan needs, and those that later plans are likely to need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"
#include "ibr/scene.h"

namespace ibr {

/// Nodes by urgency for a plan: photographs of the gather, members of the main cell, then of further cells and of the
/// previous order. Then nodes around the main cell by their distance in the graph. Only the constructor allocates.
class WantedNodes {
 public:
  WantedNodes() = default;
  /// `cells`: members of each cell; `nodeCount`: of the scene.
  WantedNodes(std::vector<std::vector<std::uint32_t>> cells, std::size_t nodeCount);

  /// At most `most` nodes beyond those that the plan shows are listed, up to `most` in all.
  void update(const FramePlan& plan, std::size_t most);

  std::span<const std::uint32_t> nodes() const noexcept { return nodes_; }
  std::size_t needed() const noexcept { return needed_; }  // the first of `nodes`: shown by the plan

 private:
  void addMembers(std::uint32_t cell);
  void addNode(std::uint32_t node);
  void reach(std::uint32_t cell);

  std::vector<std::vector<std::uint32_t>> cells_, cellsOfNode_;
  std::vector<std::uint32_t> nodes_, queue_;
  std::vector<std::uint64_t> seen_, reached_;  // by node and cell: last update that listed it
  std::uint64_t update_ = 0;
  std::size_t needed_ = 0;
};

}  // namespace ibr
