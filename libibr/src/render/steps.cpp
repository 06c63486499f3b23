// SPDX-License-Identifier: Apache-2.0
#include "render/steps.h"

namespace ibr {
namespace {

PlannedCell::View alone(std::uint32_t member) noexcept {
  PlannedCell::View weights;
  weights.position[member] = weights.blend[member] = 1.0;
  return weights;
}

// Calls `visit` with every cell of the order and its number, those that leave between them.
template <class Visit>
void forCells(const FramePlan& plan, Order order, Visit&& visit) {
  const std::vector<PlannedCell>& cells = order == Order::current ? plan.cells : plan.former;
  std::size_t left = order == Order::current ? 0 : plan.leaving.size();
  for (std::size_t c = 0; c <= cells.size(); ++c) {
    for (; left < plan.leaving.size() && plan.leaving[left].before <= c; ++left)
      visit(plan.leaving[left].planned, kNoCell, std::uint32_t(c));
    if (c < cells.size()) visit(cells[c], std::uint32_t(c), std::uint32_t(c));
  }
}

}  // namespace

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept {
  Steps steps;
  const auto add = [&](const GpuScene::State::Mesh& mesh, Tier of, Tier tier, const PlannedCell::View& weights,
                       double opacity, std::uint32_t cell, std::uint32_t table, std::uint32_t rank,
                       double extrapolation, bool hidden) {
    const GpuScene::State::Range& range = mesh.tier[of];
    hidden = hidden && order == Order::current && plan.settings.order == DrawOrder::ours;
    if (range.indexCount > 0)
      steps.step[steps.count++] = {&mesh, range, weights, tier, float(opacity), cell, table, rank, float(extrapolation),
                                   hidden};
  };
  forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
    add(scene.cells[cell.cell], kTierAgrees, kTierAgrees, cell.view[view], cell.opacity, c, cell.colourSlot, rank,
        cell.extrapolationDistance, cell.hidden);
  });
  const auto addBackdrops = [&](Tier of) {
    for (std::uint32_t b = 0; b < plan.backdrops.size(); ++b) {
      const PlannedBackdrop& backdrop = plan.backdrops[b];
      add(scene.backdrops[backdrop.backdrop], of, kTierBackdrop, alone(0), backdrop.opacity, b, backdrop.colourSlot, b,
          0.0, backdrop.hidden);
    }
  };
  const bool backdrops = plan.settings.lowestTier >= kTierBackdrop;
  if (backdrops) addBackdrops(kTierAgrees);
  if (plan.settings.lowestTier >= kTierRejected)
    forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
      add(scene.cells[cell.cell], kTierRejected, kTierRejected, {cell.single, cell.single}, cell.opacity, c,
          cell.colourSlot, rank, cell.extrapolationDistance, cell.rejectedHidden);
    });
  if (backdrops) addBackdrops(kTierRejected);
  return steps;
}

}  // namespace ibr
