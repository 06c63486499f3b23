// SPDX-License-Identifier: Apache-2.0
#include "render/passes/steps.h"

namespace ibr {

Steps stepsOf(const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept {
  Steps steps;
  if (plan.settings.composition == Composition::gathered) return steps;
  const bool mayHide =
      order == Order::current && plan.settings.order == DrawOrder::ours && plan.settings.overlay != Overlay::overlap;
  forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
    const GpuScene::State::Mesh& mesh = scene.cells[cell.cell];
    if (mesh.indices.count == 0) return;
    steps.step[steps.count++] = {&mesh,
                                 cell.view[view],
                                 float(cell.opacity),
                                 c,
                                 cell.colourSlot,
                                 rank,
                                 float(cell.extrapolationDistance),
                                 &cell.correction,
                                 mayHide && cell.hidden};
  });
  return steps;
}

}  // namespace ibr
