// SPDX-License-Identifier: Apache-2.0
#include "render/passes/draw_list.h"

namespace ibr {

namespace {

void fill(DrawList& list, const GpuScene::State& scene, const FramePlan& plan, Order order, std::size_t view) noexcept {
  if (plan.settings.composition == Composition::gathered) return;
  const bool mayHide =
      order == Order::current && plan.settings.order == DrawOrder::ours && plan.settings.overlay != Overlay::overlap;
  forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
    const GpuScene::State::Mesh& mesh = scene.cells[cell.cell];
    if (mesh.place.indices.count == 0) return;
    list.items[list.count++] = {&mesh,
                                cell.view[view],
                                float(cell.opacity),
                                c,
                                cell.colourSlot,
                                rank,
                                float(cell.extrapolationDistance),
                                &cell.correction,
                                mayHide && cell.hidden};
  });
}

}  // namespace

PlanDraws::PlanDraws(const GpuScene::State& scene, const FramePlan& of) noexcept : plan(of) {
  for (const Order order : {Order::current, Order::previous})
    for (std::size_t view = 0; view < plan.views.size(); ++view)
      fill(lists_[std::size_t(order)][view], scene, plan, order, view);
}

}  // namespace ibr
