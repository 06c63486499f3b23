// SPDX-License-Identifier: Apache-2.0
// `ibr bench` of the photographs on a device: cost of texture formats and filters, and a walk within a memory budget.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "ibr/renderer.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct PhotographBench {
  const Scene& scene;
  const std::vector<View>& views;  // all of one size
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  int repeat = 1;  // frames for each way and view
};

/// Renders frames with all formats and filters in turn; encodes the scene's textures again. Prints a table and returns
/// the report's fields.
nlohmann::ordered_json benchFormats(const PhotographBench& bench, const Context& context);

/// Renders the views in order, as a viewer does: a frame streams what it can and is shown even if textures are missing.
/// Assumes two frames in flight.
nlohmann::ordered_json benchWalk(const PhotographBench& bench, const Context& context);

}  // namespace ibr::app
