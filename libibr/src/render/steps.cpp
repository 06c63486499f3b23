// SPDX-License-Identifier: Apache-2.0
#include "render/steps.h"

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
  const auto add = [&](const GpuScene::State::Mesh& mesh, Tier tier, const PlannedCell::View& weights, double opacity,
                       std::size_t cell, std::uint32_t table) {
    const GpuScene::State::Range& range = mesh.tier[tier == kTierRejected];
    if (range.indexCount > 0)
      steps.step[steps.count++] = {&mesh, range, weights, tier, float(opacity), std::uint32_t(cell), table};
  };
  const std::vector<PlannedCell>& cells = order == Order::current ? plan.cells : plan.former;
  for (std::size_t c = 0; c < cells.size(); ++c)
    add(scene.cells[cells[c].cell], kTierAgrees, cells[c].view[view], cells[c].opacity, c, cells[c].colourSlot);
  if (plan.settings.lowestTier >= kTierRejected)
    for (std::size_t c = 0; c < cells.size(); ++c)
      add(scene.cells[cells[c].cell], kTierRejected, alone(cells[c].best), cells[c].opacity, c, cells[c].colourSlot);
  if (plan.settings.lowestTier >= kTierBackdrop)
    for (std::size_t b = 0; b < plan.backdrops.size(); ++b)
      add(scene.backdrops[plan.backdrops[b]], kTierBackdrop, alone(0), 1.0, b, plan.colour.backdropSlots[b]);
  return steps;
}

}  // namespace ibr
