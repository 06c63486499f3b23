// SPDX-License-Identifier: Apache-2.0
// Finds planned meshes that better meshes certainly hide (cover_mask.h), so that they need not be drawn. Pure;
// conservative: drawing a hidden mesh would not change a pixel.
#pragma once

#include <memory_resource>

#include "ibr/frame_plan.h"

namespace ibr {

/// Marks cells that are hidden in all views of a plan with DrawOrder::ours (PlannedCell::hidden). `memory` is used for
/// the call.
void markHidden(const Scene& scene, const SceneBounds& bounds, FramePlan& plan, std::pmr::memory_resource* memory);

}  // namespace ibr
