// SPDX-License-Identifier: Apache-2.0
#include "render/plan/draw_order.h"

namespace ibr {
namespace {

constexpr double kAlone = 2;   // a backdrop's distance counts so much: no second photograph confirms its depth
constexpr double kBand = 0.5;  // of a cell's distance, over which a backdrop passes it, its distance counted so

}  // namespace

double shareBefore(const FramePlan& plan, const PlannedBackdrop& backdrop, const PlannedCell& cell) noexcept {
  const RenderSettings& settings = plan.settings;
  const bool sequence =
      settings.colourMapping == ColourMapping::paper || settings.colourMapping == ColourMapping::paperRedraw;
  const double distance = 0.5 * (cell.extrapolationDistance + cell.photographDistance);
  if (sequence || !(distance > 0)) return 0.0;
  const double lead = 1.0 - kAlone * backdrop.distance / distance;
  if (!(settings.switchSeconds > 0)) return lead > 0 ? cell.opacity : 0.0;
  return std::clamp(0.5 + lead / kBand, 0.0, cell.opacity);
}

}  // namespace ibr
