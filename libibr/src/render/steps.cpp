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
  const auto add = [&](const GpuScene::State::Mesh& mesh, Tier tier, const PlannedCell::View& weights, double opacity) {
    const GpuScene::State::Range& range = mesh.tier[tier == kTierRejected];
    if (range.indexCount > 0) steps.step[steps.count++] = {&mesh, range, weights, tier, float(opacity)};
  };
  const std::vector<PlannedCell>& cells = order == Order::current ? plan.cells : plan.former;
  for (const PlannedCell& cell : cells) add(scene.cells[cell.cell], kTierAgrees, cell.view[view], cell.opacity);
  if (plan.settings.lowestTier >= kTierRejected)
    for (const PlannedCell& cell : cells) add(scene.cells[cell.cell], kTierRejected, alone(cell.best), cell.opacity);
  if (plan.settings.lowestTier >= kTierBackdrop)
    for (const std::uint32_t backdrop : plan.backdrops) add(scene.backdrops[backdrop], kTierBackdrop, alone(0), 1.0);
  return steps;
}

}  // namespace ibr
