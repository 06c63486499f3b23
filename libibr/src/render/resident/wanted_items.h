// SPDX-License-Identifier: Apache-2.0
// Items that a plan needs, and those that later plans are likely to need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"
#include "ibr/scene.h"
#include "render/resident/stream_items.h"

namespace ibr {

/// Items by urgency for a plan: those of the gather (photograph, depth texture, mesh), then mesh and photographs of the
/// main cell, of further cells and of the previous order. Then those around the main cell by their distance in the
/// graph. Only the constructor allocates.
class WantedItems {
 public:
  WantedItems() = default;
  /// `isStreamed`: by item; meshes and depth textures that are not streamed are left out.
  WantedItems(const Scene& scene, std::vector<bool> isStreamed);

  /// At most `most` items beyond those that the plan shows are listed, up to `most` in all.
  void update(const FramePlan& plan, std::size_t most);

  std::span<const std::uint32_t> items() const noexcept { return listed_; }
  std::size_t needed() const noexcept { return needed_; }  // the first of `items`: shown by the plan

 private:
  static constexpr std::uint32_t kNone = ~0u;

  struct From {
    std::uint32_t cell = 0;
    bool gathers = false;  // depth textures and meshes of backdrops are wanted, too
    std::size_t most = 0;
    bool operator==(const From&) const = default;
  };

  void findAround(const From& from);
  void begin(std::vector<std::uint32_t>& list);
  void addCell(std::uint32_t cell);
  void addGathered(std::uint32_t node);
  void addStreamed(std::uint32_t item);
  void add(std::uint32_t item);
  void reach(std::uint32_t cell);

  StreamItems items_;
  std::vector<bool> isStreamed_;
  std::vector<std::vector<std::uint32_t>> cells_, cellsOfNode_;
  std::vector<std::uint32_t> backdropOfNode_;  // kNone: the photograph cannot be gathered from
  std::vector<std::uint32_t> listed_, queue_;
  std::vector<std::uint32_t> around_;           // items around the cell of from_, nearest first
  std::optional<From> from_;                    // of around_
  std::vector<std::uint32_t>* list_ = nullptr;  // the list that add() appends to
  std::vector<std::uint64_t> seen_, reached_;   // by item and cell: last list that has it
  std::uint64_t update_ = 0;                    // number of the list
  std::size_t needed_ = 0;
};

}  // namespace ibr
