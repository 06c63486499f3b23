// SPDX-License-Identifier: Apache-2.0
// The image graph over pictures, as --graph and the viewer show it.
#pragma once

#include <span>

#include "ibr/graph_overlay.h"
#include "ibr/htm_model.h"
#include "ibr/renderer.h"

namespace ibr::app {

/// Frusta are a third as long as photographs are apart.
GraphOverlay graphLines(Device& device, const Scene& scene, VkFormat format);
GraphOverlay graphLines(Device& device, const HtmModel& model, VkFormat format);  // photographs alone

/// Records it over a frame's pictures, which have just been recorded.
void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const FramePlan& plan,
                 std::span<const Target> pictures);
void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const Camera& view, const Target& picture);

}  // namespace ibr::app
