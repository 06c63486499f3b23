// SPDX-License-Identifier: Apache-2.0
#include "render/passes/steps.h"

namespace ibr {
namespace {

PlannedCell::View alone(std::uint32_t member) noexcept {
  PlannedCell::View weights;
  weights.position[member] = weights.blend[member] = 1.0;
  return weights;
}

}  // namespace

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept {
  Steps steps;
  if (plan.settings.composition == Composition::gathered) return steps;
  const auto add = [&](const GpuScene::State::Mesh& mesh, Tier of, Tier tier, const PlannedCell::View& weights,
                       double opacity, std::uint32_t cell, std::uint32_t table, std::uint32_t rank,
                       double extrapolation, const Correction& correction, bool hidden) {
    const GpuScene::State::IndexRange& range = mesh.tier[of];
    hidden = hidden && order == Order::current && plan.settings.order == DrawOrder::ours &&
             plan.settings.overlay != Overlay::overlap;
    if (range.indexCount > 0)
      steps.step[steps.count++] = {
          &mesh, range, weights, tier, float(opacity), cell, table, rank, float(extrapolation), &correction, hidden};
  };
  const auto addBackdrop = [&](Tier of, std::uint32_t b, double share) {
    const PlannedBackdrop& backdrop = plan.backdrops[b];
    add(scene.backdrops[backdrop.backdrop], of, kTierBackdrop, alone(0), backdrop.opacity * share, b,
        backdrop.colourSlot, b, 0.0, backdrop.correction, backdrop.hidden);
  };
  if (plan.settings.composition == Composition::hybrid) {
    forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
      add(scene.cells[cell.cell], kTierAgrees, kTierAgrees, cell.view[view], cell.opacity, c, cell.colourSlot, rank,
          cell.extrapolationDistance, cell.correction, cell.hidden);
    });
    return steps;
  }
  const BackdropShares shown = forTier0(
      plan, order, scene.backdrops.size(), [&](std::uint32_t b, double share) { addBackdrop(kTierAgrees, b, share); },
      [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
        add(scene.cells[cell.cell], kTierAgrees, kTierAgrees, cell.view[view], cell.opacity, c, cell.colourSlot, rank,
            cell.extrapolationDistance, cell.correction, cell.hidden);
      });
  if (plan.settings.lowestTier >= kTierRejected)
    forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
      add(scene.cells[cell.cell], kTierRejected, kTierRejected, {cell.single, cell.single}, cell.opacity, c,
          cell.colourSlot, rank, cell.extrapolationDistance, cell.correction, cell.rejectedHidden);
    });
  for (std::uint32_t b = 0; b < plan.backdrops.size(); ++b)
    if (shown[b] < 1) addBackdrop(kTierAgrees, b, 1);
  for (std::uint32_t b = 0; b < plan.backdrops.size(); ++b) addBackdrop(kTierRejected, b, 1);
  return steps;
}

}  // namespace ibr
