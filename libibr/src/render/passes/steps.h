// SPDX-License-Identifier: Apache-2.0
// What is drawn for one view, in order: a step is one tier of one mesh.
//
//   all of tier 0, main cell first; before a cell that is more than twice as far from the view as a backdrop's
//   photograph, that backdrop's tier 0 (shareBefore in render/plan/draw_order.h: the rule, its constants and units);
//   then all of tier 1, each cell from its best member alone;
//   then backdrops (tier 2), what they have of tier 0 first, then what closes them across depth edges.
//   Cells that leave stand at the places that they had
//   Composition::hybrid: tier 0 of cells alone; gathered: nothing
//
// A photograph from the view's own place is right whatever its depth, where a cell misses what its members do not all
// see.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ibr/renderer.h"
#include "render/plan/draw_order.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

inline constexpr std::uint32_t kLargestStepCount =
    2 * (kLargestCellCount + kLargestLeavingCount) + 8 * kLargestBackdropCount;

struct Step {
  const GpuScene::State::Mesh* mesh;
  GpuScene::State::IndexRange range;
  PlannedCell::View weights;  // tier 0 as planned; else one member alone, so that what disagrees cannot ghost
  Tier tier;
  float opacity;
  std::uint32_t cell;   // among the planned cells (tiers 0 and 1) or backdrops; kNoCell for one that leaves
  std::uint32_t table;  // colour slot
  std::uint32_t rank;   // of the cell, or of that before which a leaving one is drawn; of a backdrop among backdrops
  float extrapolation;  // PlannedCell::extrapolationDistance
  const Correction* correction;  // of the plan, which must outlive the step
  bool hidden;                   // with our order, better steps cover it for certain; not where overlaps are counted
};

/// Best first, without allocation.
struct Steps {
  std::array<Step, kLargestStepCount> step;
  std::uint32_t count = 0;

  std::span<const Step> all() const { return {step.data(), count}; }
};

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept;

}  // namespace ibr
