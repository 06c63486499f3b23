// SPDX-License-Identifier: Apache-2.0
// `ibr bench`, of photographs on a device: what formats and filters cost, and a walk under a budget of memory.
#pragma once

#include <nlohmann/json.hpp>
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
  int repeat = 1;  // frames of each way and view
};

/// Frames of all formats and filters in turn, with the scene's textures encoded anew. Prints a table, returns what the
/// report says.
nlohmann::ordered_json benchFormats(const PhotographBench& bench, const Context& context);

/// Goes through the views as a viewer does: a frame streams what it can and is shown, whatever is still missing. Two
/// frames are taken to be in flight.
nlohmann::ordered_json benchWalk(const PhotographBench& bench, const Context& context);

}  // namespace ibr::app
