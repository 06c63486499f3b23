// SPDX-License-Identifier: Apache-2.0
// Converts a plan's photographs from double precision to the gather's parameters. All are relative to the view, in
// units of the capture spacing, so that the device needs no world coordinate.
#pragma once

#include "render/resident/gpu_scene_state.h"
#include "shared/gather.h"

namespace ibr {

/// `drawn`: extent of the view's image as it is drawn, px.
shader::GatherView gatherView(const GpuScene::State& scene, const FramePlan& plan, std::size_t view,
                              VkExtent2D drawn) noexcept;

}  // namespace ibr
