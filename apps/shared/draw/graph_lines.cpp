// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/graph_lines.h"

#include <algorithm>
#include <array>

#include "shared/camera/roaming.h"

namespace ibr::app {
namespace {

GraphOverlay linesOf(Device& device, const ImageGraph& graph, VkFormat format) {
  std::vector<Pose> poses;
  for (const Camera& camera : graph.photographs) poses.push_back(camera.pose);
  return {device, graph, {.frustumDepth = neighbourDistance(poses).value_or(1) / 3, .formats = {format}}};
}

Target recorded(Target picture) {
  picture.initialUse = picture.finalUse;
  return picture;
}

}  // namespace

GraphOverlay graphLines(Device& device, const Scene& scene, VkFormat format) {
  return linesOf(device, imageGraph(scene), format);
}

GraphOverlay graphLines(Device& device, const HtmModel& model, VkFormat format) {
  ImageGraph graph;
  for (const HtmCamera& camera : model.cameras) graph.photographs.push_back(camera.camera);
  return linesOf(device, graph, format);
}

void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const FramePlan& plan,
                 std::span<const Target> pictures) {
  std::array<std::uint32_t, kMaxCellCount> best;
  const std::size_t count = std::min<std::size_t>(plan.cells.size(), best.size());
  for (std::size_t rank = 0; rank < count; ++rank) best[rank] = plan.cells[rank].cell;
  for (std::size_t view = 0; view < pictures.size(); ++view)
    graph.record(commands, plan.views[view], std::span(best).first(count), recorded(pictures[view]));
}

void recordGraph(VkCommandBuffer commands, const GraphOverlay& graph, const Camera& view, const Target& picture) {
  graph.record(commands, view, {}, recorded(picture));
}

}  // namespace ibr::app
