// SPDX-License-Identifier: Apache-2.0
// The image graph drawn over images, for --graph and the viewer.
#pragma once

#include <span>

#include "ibr/graph_overlay.h"
#include "ibr/htm_model.h"
#include "ibr/renderer.h"

namespace ibr::app {

/// Builds the graph; the length of the frusta is a third of the distance between photographs.
GraphOverlay graphLines(Device& device, const Scene& scene, VkFormat format);
GraphOverlay graphLines(Device& device, const HtmModel& model, VkFormat format);  // photographs only

/// Records the graph over the images of a frame that were recorded before.
void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const FramePlan& plan,
                 std::span<const Target> pictures);
void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const Camera& view, const Target& picture);

}  // namespace ibr::app
