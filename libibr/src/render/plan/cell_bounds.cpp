// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>

#include "base/stop.h"
#include "ibr/frame_plan.h"
#include "render/photographs/photograph_choice.h"
#include "render/plan/anchors.h"
#include "render/plan/outline.h"
#include "render/plan/scene_index.h"
#include "render/plan/vertex.h"

namespace ibr {
namespace {

CellBounds boundsOf(const Scene& scene, const Cell& cell) {
  CellBounds bounds;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    CellBounds::Member& member = bounds.members[i];
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
      const glm::vec3 point(memberPoint(scene, cell, i, p)), ray = glm::normalize(point);
      member.low = p ? glm::min(member.low, point) : point;
      member.high = p ? glm::max(member.high, point) : point;
      member.unitLow = p ? glm::min(member.unitLow, ray) : ray;
      member.unitHigh = p ? glm::max(member.unitHigh, ray) : ray;
    }
    for (std::size_t j = 0; j < i; ++j)
      bounds.size = std::max(bounds.size, glm::distance(scene.nodes[cell.members[i]].camera.pose.position,
                                                        scene.nodes[cell.members[j]].camera.pose.position));
  }
  for (float inverseDistance : cell.mesh.inverseDistance)
    bounds.maxInverseDistance = std::max(bounds.maxInverseDistance, inverseDistance);
  addOutline(scene, cell, bounds);
  bounds.surface = surfacePoints(scene, cell);
  return bounds;
}

}  // namespace

SceneBounds sceneBounds(const Scene& scene, bool alignCells, const std::stop_token& stop) {
  SceneBounds bounds;
  for (const Cell& cell : scene.cells) {
    checkStop(stop, "computing a scene's bounds");
    bounds.cells.push_back(boundsOf(scene, cell));
  }
  const auto index = std::make_shared<SceneBounds::Index>();
  index->masked = std::ranges::any_of(scene.nodes, [](const Node& node) { return !node.maskFile.empty(); });
  index->cells = makeCellIndex(scene, bounds.cells);
  index->photographs = makePhotographIndex(scene);
  if (!index->photographs.photographs.empty()) bounds.gather = gatherStatistics(scene, stop);
  bounds.index = index;
  bounds.anchors = std::make_shared<SceneBounds::Anchors>();
  if (alignCells) bounds.anchors->of(scene, stop);
  return bounds;
}

}  // namespace ibr
