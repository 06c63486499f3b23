// SPDX-License-Identifier: Apache-2.0
// As how bright a frame shows its photographs ([T] §2.5.3, "the human eye adapts").
#pragma once

#include "ibr/renderer.h"

namespace ibr {

/// FramePlan::exposure; PlanState::exposure of the plan's `next` is set. Of Exposure::adapted the inverse of the mean
/// gain (of logs, by the weights of blending) of the main cell's members; where no cell is drawn, of the planned
/// photographs by the root of their shares over the fourth power of their distance. It is followed with the time
/// constant RenderSettings::exposureSeconds. `seconds`: since the frame before.
glm::dvec3 plannedExposure(const Scene& scene, double seconds, const PlanState& state, FramePlan& plan);

}  // namespace ibr
