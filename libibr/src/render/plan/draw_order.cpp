// SPDX-License-Identifier: Apache-2.0
#include "render/plan/draw_order.h"

namespace ibr {
double shareBefore(const FramePlan& plan, const PlannedBackdrop& backdrop, const PlannedCell& cell) noexcept {
  const RenderSettings& settings = plan.settings;
  const bool sequence =
      settings.colourMapping == ColourMapping::paper || settings.colourMapping == ColourMapping::paperRedraw;
  const double distance = 0.5 * (cell.extrapolationDistance + cell.photographDistance);
  if (sequence || !(distance > 0)) return 0.0;
  const double lead = 1.0 - kBackdropDistanceFactor * backdrop.distance / distance;
  if (!(settings.switchSeconds > 0)) return lead > 0 ? cell.opacity : 0.0;
  return std::clamp(0.5 + lead / kPassingBand, 0.0, cell.opacity);
}

}  // namespace ibr
