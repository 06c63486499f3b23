// SPDX-License-Identifier: Apache-2.0
#include "render/steps.h"

#include <algorithm>
#include <utility>

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

constexpr double kAlone = 2;            // a backdrop's distance counts so much: no second photograph confirms its depth
constexpr double kBand = 0.5;           // of a cell's distance, over which a backdrop passes it
constexpr double kLeastShare = 0.0625;  // that another copy of a backdrop is drawn for

}  // namespace

double shareBefore(const FramePlan& plan, const PlannedBackdrop& backdrop, const PlannedCell& cell) noexcept {
  const RenderSettings& settings = plan.settings;
  const bool sequence =
      settings.colourMapping == ColourMapping::paper || settings.colourMapping == ColourMapping::paperRedraw;
  const double distance = 0.5 * (cell.extrapolationDistance + cell.photographDistance);
  if (sequence || !(distance > 0)) return 0.0;
  const double lead = 1.0 - kAlone * backdrop.distance / distance;
  if (!(settings.switchSeconds > 0)) return lead > 0 ? 1.0 : 0.0;
  return std::clamp(0.5 + lead / kBand, 0.0, 1.0);
}

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
  const std::uint32_t backdrops = plan.settings.lowestTier >= kTierBackdrop ? std::uint32_t(plan.backdrops.size()) : 0;
  std::array<double, 2 * kLargestBackdropCount> shown{};  // share of each backdrop so far
  const auto addBackdrop = [&](Tier of, std::uint32_t b) {
    const PlannedBackdrop& backdrop = plan.backdrops[b];
    add(scene.backdrops[backdrop.backdrop], of, kTierBackdrop, alone(0), backdrop.opacity * shown[b], b,
        backdrop.colourSlot, b, 0.0, backdrop.hidden);
  };
  // Copies of a backdrop use one noise: each adds to those before it.
  std::size_t copies = copiesBeforeCells(scene.backdrops.size());
  const auto addBackdropsBefore = [&](const PlannedCell& cell) {
    for (std::uint32_t b = 0; b < backdrops; ++b) {
      const double share = shareBefore(plan, plan.backdrops[b], cell);
      if (copies == 0 || !(share >= std::min(1.0, shown[b] + kLeastShare)) || shown[b] == 1) continue;
      shown[b] = share;
      addBackdrop(kTierAgrees, b);
      --copies;
    }
  };
  forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
    addBackdropsBefore(cell);
    add(scene.cells[cell.cell], kTierAgrees, kTierAgrees, cell.view[view], cell.opacity, c, cell.colourSlot, rank,
        cell.extrapolationDistance, cell.hidden);
  });
  if (plan.settings.lowestTier >= kTierRejected)
    forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t c, std::uint32_t rank) {
      add(scene.cells[cell.cell], kTierRejected, kTierRejected, {cell.single, cell.single}, cell.opacity, c,
          cell.colourSlot, rank, cell.extrapolationDistance, cell.rejectedHidden);
    });
  for (std::uint32_t b = 0; b < backdrops; ++b)
    if (std::exchange(shown[b], 1.0) < 1) addBackdrop(kTierAgrees, b);
  for (std::uint32_t b = 0; b < backdrops; ++b) addBackdrop(kTierRejected, b);
  return steps;
}

}  // namespace ibr
