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

  static constexpr std::size_t kMaxListed = 384;  // unless a plan shows more

  /// Lists the items that the plan shows, then others up to `most` and kMaxListed in all.
  void update(const FramePlan& plan, std::size_t most);

  std::span<const std::uint32_t> items() const noexcept { return listed_; }
  std::size_t needed() const noexcept { return needed_; }  // the first of `items`: shown by the plan

 private:
  static constexpr std::uint32_t kNone = ~0u;

  // Lists of indices, beside each other in memory.
  struct Lists {
    std::vector<std::uint32_t> ends, values;
    std::span<const std::uint32_t> operator[](std::size_t list) const {
      const std::uint32_t first = list > 0 ? ends[list - 1] : 0;
      return std::span(values).subspan(first, ends[list] - first);
    }
  };
  struct From {
    std::uint32_t cell = 0;
    bool gathers = false;  // depth textures and meshes of backdrops are wanted, too
    std::size_t most = 0;
    bool operator==(const From&) const = default;
  };

  void findAround(const From& from);
  void begin(std::vector<std::uint32_t>& list);
  static Lists cellsOfNodes(const Lists& cells, std::size_t nodeCount);
  void addCell(std::uint32_t cell);
  void addGathered(std::uint32_t node);
  void addStreamed(std::uint32_t item);
  void add(std::uint32_t item);
  void reach(std::uint32_t cell);

  StreamItems items_;
  std::vector<bool> isStreamed_;
  Lists cells_, cellsOfNode_;                  // members of each cell, and the cells of each photograph
  std::vector<std::uint32_t> backdropOfNode_;  // kNone: the photograph cannot be gathered from
  std::vector<std::uint32_t> listed_, queue_;
  std::vector<std::uint32_t> around_;            // items around the cell of from_, nearest first
  std::optional<From> from_;                     // of around_
  std::vector<std::uint32_t>* list_ = nullptr;   // the list that add() appends to
  std::vector<std::uint64_t> seen_;              // by item: last list that has it
  std::vector<std::uint64_t> reached_, opened_;  // by cell and photograph: last list around a cell that reached it
  std::uint64_t update_ = 0;                     // number of the list
  std::size_t needed_ = 0;
};

}  // namespace ibr
