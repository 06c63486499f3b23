// SPDX-License-Identifier: Apache-2.0
// Which slot holds which cell's colour table and how tables move in this frame ([T] §2.5.3, "to smooth out this
// transition"). Pure.
#pragma once

#include "ibr/renderer.h"

namespace ibr {

/// `plan` is complete but for colours; `seconds` since the frame before, clamped. Where colours are not mapped, what
/// was remembered of them is forgotten.
void planColours(double seconds, const PlanState& state, FramePlan& plan);

/// Both views take the same tables.
inline bool eyesShare(const FramePlan& plan) {
  return plan.views.size() == 1 || plan.settings.shareEyeColours;
}

}  // namespace ibr
