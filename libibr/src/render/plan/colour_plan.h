// SPDX-License-Identifier: Apache-2.0
// Assigns colour table slots to cells and plans how the tables change in this frame ([T] §2.5.3, "to smooth out this
// transition"). Pure.
#pragma once

#include <memory_resource>

#include "ibr/frame_plan.h"

namespace ibr {

/// `plan` is complete except for colours. `seconds`: since the previous frame, clamped. With ColourMapping::off the
/// state of colours is reset. `memory` is used for the call.
void planColours(double seconds, const PlanState& state, FramePlan& plan,
                 std::pmr::memory_resource* memory = std::pmr::get_default_resource());

/// True if both views use the same tables.
inline bool eyesShare(const FramePlan& plan) {
  return plan.views.size() == 1 || plan.settings.shareEyeColours;
}

}  // namespace ibr
