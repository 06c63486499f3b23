// SPDX-License-Identifier: Apache-2.0
// From a plan's photographs in double precision to what the gather reads: relative to the view, in units of the capture
// spacing, so that the device never sees a world coordinate.
#pragma once

#include "render/resident/gpu_scene_state.h"
#include "shared/gather.h"

namespace ibr {

/// `drawn`: of the image as it is drawn, px.
shader::GatherView gatherView(const GpuScene::State& scene, const FramePlan& plan, std::size_t view,
                              VkExtent2D drawn) noexcept;

}  // namespace ibr
