// SPDX-License-Identifier: Apache-2.0
// The cells that are drawn for one view, in order: tier 0 of each, main cell first; those that leave stand at the
// places that they had. Composition::gathered draws none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ibr/renderer.h"
#include "render/plan/draw_order.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

inline constexpr std::uint32_t kLargestStepCount = kLargestCellCount + kLargestLeavingCount;

struct Step {
  const GpuScene::State::Mesh* mesh;
  PlannedCell::View weights;
  float opacity;
  std::uint32_t cell;            // among the planned cells; kNoCell for one that leaves
  std::uint32_t table;           // colour slot
  std::uint32_t rank;            // of the cell, or of that before which a leaving one is drawn
  float extrapolation;           // PlannedCell::extrapolationDistance
  const Correction* correction;  // of the plan, which must outlive the step
  bool hidden;                   // with our order, better cells cover it for certain; not where overlaps are counted
};

/// Best first, without allocation.
struct Steps {
  std::array<Step, kLargestStepCount> step;
  std::uint32_t count = 0;

  std::span<const Step> all() const { return {step.data(), count}; }
};

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept;

}  // namespace ibr
