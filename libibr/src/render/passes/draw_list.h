// SPDX-License-Identifier: Apache-2.0
// Draw lists of a plan's views: tier 0 of each cell, main cell first. Cells that fade out keep their previous ranks.
// Composition::gathered draws no cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ibr/renderer.h"
#include "render/plan/draw_order.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

inline constexpr std::uint32_t kMaxDrawItemCount = kMaxCellCount + kMaxFadingOutCount;

struct DrawItem {
  const GpuScene::State::Mesh* mesh;
  PlannedCell::View weights;
  float opacity;
  std::uint32_t cell;            // index among the planned cells; kNoCell: fades out
  std::uint32_t table;           // colour slot
  std::uint32_t rank;            // of the cell; for a cell that fades out, of the cell that it is drawn before
  float extrapolation;           // PlannedCell::extrapolationDistance
  const Correction* correction;  // of the plan, which must outlive the item
  bool hidden;                   // DrawOrder::ours: better cells certainly cover it; false where overlaps are counted
};

/// Best first. Does not allocate.
struct DrawList {
  std::array<DrawItem, kMaxDrawItemCount> items;
  std::uint32_t count = 0;

  std::span<const DrawItem> all() const { return {items.data(), count}; }
};

/// A plan and its draw lists, about 40 KiB, made once per frame. Plan and scene must outlive it.
class PlanDraws {
 public:
  PlanDraws(const GpuScene::State& scene, const FramePlan& plan) noexcept;
  const DrawList& list(Order order, std::size_t view) const noexcept { return lists_[std::size_t(order)][view]; }

  const FramePlan& plan;

 private:
  std::array<std::array<DrawList, 2>, 2> lists_;  // by order and view
};

}  // namespace ibr
