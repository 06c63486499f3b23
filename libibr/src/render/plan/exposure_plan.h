// SPDX-License-Identifier: Apache-2.0
// Plans the brightness and white balance of a frame ([T] §2.5.3, "the human eye adapts").
#pragma once

#include "ibr/frame_plan.h"

namespace ibr {

/// Returns FramePlan::exposure and sets PlanState::exposure of the plan's `next`. The target of Exposure::adapted is
/// the inverse of the main cell's mean gain: a mean of logs with the blend weights. Without cells the photographs of
/// the gather count, by the root of their share over the fourth power of their distance. Exposure follows the target
/// with the time constant RenderSettings::exposureSeconds. `seconds`: since the previous frame.
glm::dvec3 plannedExposure(const Scene& scene, double seconds, const PlanState& state, FramePlan& plan);

}  // namespace ibr
