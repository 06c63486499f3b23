// SPDX-License-Identifier: Apache-2.0
// What is drawn for one view, in order: a step is one tier of one mesh.
//
//   all of tier 0, main cell first; then what backdrops (tier 2) have of tier 0: their depths are those of all cells
//   together, so they are right more often than a triangle that its own cell rejected; then all of tier 1, each cell
//   from its best member alone; then what closes backdrops across depth edges. Cells that leave stand at the places
//   that they had
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ibr/renderer.h"
#include "render/gpu_scene.h"

namespace ibr {

inline constexpr std::uint32_t kLargestStepCount =
    2 * (kLargestCellCount + kLargestLeavingCount + 2 * kLargestBackdropCount);

inline constexpr std::uint32_t kNoCell = ~0u;

struct Step {
  const GpuScene::State::Mesh* mesh;
  GpuScene::State::Range range;
  PlannedCell::View weights;  // tier 0 as planned; else one member alone, so that what disagrees cannot ghost
  Tier tier;
  float opacity;
  std::uint32_t cell;   // among the planned cells (tiers 0 and 1) or backdrops; kNoCell for one that leaves
  std::uint32_t table;  // colour slot
  std::uint32_t rank;   // of the cell, or of that before which a leaving one is drawn; of a backdrop among backdrops
  float extrapolation;  // PlannedCell::extrapolationDistance
  bool hidden;          // with our order, better steps cover it for certain
};

/// Best first, without allocation.
struct Steps {
  std::array<Step, kLargestStepCount> step;
  std::uint32_t count = 0;

  std::span<const Step> all() const { return {step.data(), count}; }
};

/// The picture of the plan's order, or of the order before a switch.
enum class Order : std::uint8_t { current, former };

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept;

}  // namespace ibr
